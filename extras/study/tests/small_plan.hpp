// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plans of studies that take a moment.
#pragma once

#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/plan.hpp>
#include <utility>
#include <vector>

namespace morula::study {

/// A coarse limb with a small tree of each method and 4 samples of each motion. Without mixes, needles and presses.
inline Plan coarse_plan(const std::vector<Method>& methods, std::vector<FollowRule> rules,
                        std::vector<Deformations> motions = {{Stretch{}}, {Bend{60}}}) {
  Plan plan;
  plan.bodies = {{"limb", sample_body("limb", 8)}};
  plan.sources = sources_of(plan.bodies, methods);
  plan.motions = std::move(motions);
  plan.rules = std::move(rules);
  plan.samples = 4;
  plan.resolution = 24;
  plan.branching = 4;
  plan.depth = 2;
  plan.needle_sides = 0;
  plan.cost_repeats = 1;
  return plan;
}

}  // namespace morula::study
