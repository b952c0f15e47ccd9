// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What updates cost: the one part of a study that is measured in time and differs from run to run.
#pragma once

#include "study/run.hpp"

namespace morula::cli {

struct UpdateCost {
  std::string name;
  double nanoseconds_per_vertex = 0;  // one thread; median over repeats of all samples of all motions
  double points_per_vertex = 0;       // points looked at; 0 where boxes are updated
};

struct StudyCost {
  std::string body;
  std::string method;
  std::size_t vertices = 0;
  std::vector<UpdateCost> rules;  // each on all levels
  std::vector<UpdateCost> boxes;  // boxes (6-DOPs) and 18-DOPs over the same tree
  std::vector<UpdateCost> mixes;

  /// nullptr when it was not measured.
  const UpdateCost* find(std::string_view name) const;
};

/// On the first body and the tree of the method `medial`, or the first one there is. Kept in the cache as well: the
/// same folder keeps its figures.
StudyCost measure_cost(const StudyPlan& plan, const StudyResult& result, const StudyCache& cache);
Json cost_json(const StudyCost& cost);

}  // namespace morula::cli
