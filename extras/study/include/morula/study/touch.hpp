// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Touch: two copies of a body that deform and touch; contacts under budgets are compared with brute force.
#pragma once

#include <morula/geometry/rigid_transform.hpp>
#include <morula/study/plan.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <vector>

namespace morula::study {

/// The motion of one copy, and its transform.
struct TouchSide {
  Deformations motion;
  RigidTransform transform;
};

struct TouchPlan {
  TouchSide a, b;
  std::size_t frames = 5;  ///< frames from rest to the full amount, at least 2
  /// Pair tests per frame; no value: no limit.
  std::vector<std::optional<std::size_t>> budgets{100, 500, 2000, 10000, std::nullopt};
  int timed_queries = 5;  ///< repeats of each query

  /// Two copies like arms, one on the other, crossed along z: the bends move them into each other, the twist rotates
  /// the touching parts.
  static TouchPlan crossed_arms(const Mesh& mesh);
};

/// One budget, over all frames.
struct TouchRow {
  std::optional<std::size_t> budget;
  double contacts = 0;          ///< average number per frame
  double finished_share = 0;    ///< share of finished contacts
  std::size_t missed = 0;       ///< crossings with a point outside all contacts
  double mean_error_bound = 0;  ///< share of the box's diagonal at rest
  double pair_tests = 0;        ///< average number per frame
  double seconds = 0;           ///< seconds of a query, median, one thread
};

struct Touch {
  std::vector<std::size_t> crossings;    ///< per frame: pairs of facets that intersect, by brute force
  std::vector<TouchRow> rows;            ///< one per budget
  std::vector<Vec3> middle_a, middle_b;  ///< vertices in the middle frame, in the world

  std::size_t crossing_count() const;
};

/// Runs the plan. model: a tree of the mesh.
Touch run_touch(const TouchPlan& plan, const Mesh& mesh, const CoveredTree& model);

}  // namespace morula::study
