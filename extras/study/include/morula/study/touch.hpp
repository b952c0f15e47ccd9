// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Touch: an experiment of the study. Two copies of a body deform and touch; contacts of queries with budgets are
// compared with the crossings of all facets, found by brute force.
#pragma once

#include <morula/geometry/rigid_transform.hpp>
#include <morula/study/plan.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <vector>

namespace morula::study {

/// One of the two copies: its deformation and its fixed transform.
struct TouchSide {
  Deformations motion;
  RigidTransform transform;
};

/// The input of the experiment.
struct TouchPlan {
  TouchSide a, b;
  std::size_t frames = 5;  ///< number of frames, from rest to the full amount of the deformations; at least 2
  /// Budgets of the queries, pair tests per frame; no value: no limit.
  std::vector<std::optional<std::size_t>> budgets{100, 500, 2000, 10000, std::nullopt};
  int timed_queries = 5;  ///< number of repeats of each query, of which the times are taken; at least 1

  /// Two copies of a body along x, like arms: b is rotated by a right angle about z and lies above a, by 0.17 of the
  /// diagonal of the body's box. They bend toward each other, and a twist rotates the touching part of b.
  static TouchPlan crossed_arms(const Mesh& mesh);
};

/// The results with one budget, over all frames.
struct TouchRow {
  std::optional<std::size_t> budget;  ///< pair tests; no value: no limit
  double contacts = 0;                ///< average number of contacts per frame
  double finished_share = 0;          ///< share of all contacts that are finished, 0 to 1
  /// Number of crossings, in all frames, of which an end or the middle lies in no contact; 0 is expected.
  std::size_t missed = 0;
  double mean_error_bound = 0;  ///< mean Contact::error_bound; share of the diagonal of the body's box at rest
  double pair_tests = 0;        ///< average number of pair tests per frame
  double seconds = 0;           ///< median of the times of single queries, seconds, on one thread
};

/// The results of the experiment.
struct Touch {
  std::vector<std::size_t> crossings;    ///< for each frame, the number of pairs of facets that intersect
  std::vector<TouchRow> rows;            ///< one per budget
  std::vector<Vec3> middle_a, middle_b;  ///< vertices of a and b in the middle frame, world coordinates

  /// The sum of `crossings`.
  std::size_t crossing_count() const;
};

/// Runs the experiment with the rule `exact`. mesh: the body at rest; model: built from it. Throws
/// std::invalid_argument if they do not belong together.
Touch run_touch(const TouchPlan& plan, const Mesh& mesh, const CoveredTree& model);

}  // namespace morula::study
