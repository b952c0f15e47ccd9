// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Cost of updates: the only part of a study that measures time and differs from run to run.
#pragma once

#include <morula/study/run.hpp>
#include <string_view>

namespace morula::study {

struct UpdateCost {
  std::string name;
  double nanoseconds_per_vertex = 0;  ///< one thread; median over repeats of all samples of all motions
  double lower_quartile = 0, upper_quartile = 0;
  double points_per_vertex = 0;  ///< number of points read; 0 if boxes are updated
};

struct Cost {
  std::size_t source = 0;  ///< shown_tree() of the plan
  std::size_t vertices = 0;
  std::vector<UpdateCost> rules;  ///< each rule on all levels
  std::vector<UpdateCost> boxes;  ///< boxes (6-DOPs) and 18-DOPs over the same tree
  std::vector<UpdateCost> mixes;

  /// The cost by the rule's name, "boxes", "18-DOPs" or the mix's name; nullptr if it was not measured.
  const UpdateCost* find(std::string_view name) const;
};

/// Measures the tree that represents the first body. All rules take turns in each round, so that all of them meet the
/// same disturbances. The cache stores the figures, so the same folder keeps them.
Cost measure_cost(const Plan& plan, const Result& result, const Cache* cache = nullptr);

}  // namespace morula::study
