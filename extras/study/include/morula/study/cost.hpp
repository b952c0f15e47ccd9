// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cost of updates: the one part of a study that is measured in time and differs from run to run.
#pragma once

#include <morula/study/run.hpp>
#include <string_view>

namespace morula::study {

struct UpdateCost {
  std::string name;
  double nanoseconds_per_vertex = 0;  ///< one thread; median over repeats of all samples of all motions
  double points_per_vertex = 0;       ///< points looked at; 0 where boxes are updated
};

struct Cost {
  std::size_t source = 0;  ///< shown_tree() of the plan
  std::size_t vertices = 0;
  std::vector<UpdateCost> rules;  ///< each on all levels
  std::vector<UpdateCost> boxes;  ///< boxes (6-DOPs) and 18-DOPs over the same tree
  std::vector<UpdateCost> mixes;

  /// By the rule's name, "boxes", "18-DOPs" or the mix's name; nullptr when it was not measured.
  const UpdateCost* find(std::string_view name) const;
};

/// On the tree that stands for the first body. Kept in the cache as well: the same folder keeps its figures.
Cost measure_cost(const Plan& plan, const Result& result, const Cache* cache = nullptr);

}  // namespace morula::study
