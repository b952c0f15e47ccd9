// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Press: a bent body and its copy, turned by a right angle, are pressed together by known amounts, and the contacts of
// their spheres are held against the exact triangles.
#pragma once

#include <morula/collide/crossings.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/study/plan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// How far a query for contacts goes.
struct PressQuery {
  std::size_t level = 0;
  bool leaves = false;                ///< `level` is then the tree's last one
  std::optional<std::size_t> budget;  ///< pair tests; of leaves
  /// "level 1", "500 tests", "leaves"
  std::string name() const;
};

/// Inner levels, then leaves with each budget, then all leaves.
std::vector<PressQuery> press_queries(const Plan& plan);

/// The truth about the bodies at one amount, by exact verdicts on triangles: no tree is in it.
struct PressTruth {
  Axis axis = Axis::x;       ///< b is turned about it by a right angle, and pressed against it
  double amount = 0;         ///< share of the diagonal, along the axis, from where they touch
  RigidTransform transform;  ///< of b; a stays
  std::vector<Crossing> crossings;
  Vec3 normal;       ///< from b to a: minus the mean outward normal of a's surface inside b
  double depth = 0;  ///< how far b has to go against it for no facets to cross
};

/// Where a body is pressed: the same for all trees and rules.
struct PressScene {
  std::size_t body = 0;
  std::vector<Vec3> positions;     ///< of both bodies, in their own frames
  double diagonal = 0;             ///< of the body at rest
  std::vector<PressTruth> truths;  ///< axes × amounts; the shortest side of the body first
};

/// What contacts of one query say at one amount. Depths are shares of the true one; angles are in degrees.
struct PressFigures {
  Axis axis = Axis::x;
  std::size_t amount = 0;  ///< which of the plan's
  std::size_t query = 0;   ///< which of press_queries
  double true_depth = 0;   ///< share of the diagonal at rest
  std::size_t pair_tests = 0;
  std::size_t contacts = 0;
  std::size_t finished = 0;
  std::size_t kept = 0;       ///< whose corrected depth is not 0
  double depth_spheres = 0;   ///< the largest
  double depth_surfaces = 0;  ///< the largest, corrected
  /// Of contacts' normals from the true ones about them; nothing without contacts, or without any that is kept.
  std::optional<double> normal_spheres, normal_spheres_90;
  std::optional<double> normal_surfaces, normal_surfaces_90;
  /// Of the sum of normals, weighted by depth, from the true normal of all.
  std::optional<double> net_spheres, net_surfaces;
  std::size_t crossings = 0;  ///< pairs of facets
  std::size_t lost = 0;       ///< of them, in the regions of no contact
  double error_bound = 0;     ///< the mean, share of the diagonal at rest
};

/// One tree of one body by one rule: axes × amounts × queries.
struct PressCell {
  std::size_t source = 0;  ///< of Plan::pressed
  std::size_t rule = 0;    ///< in Plan::press_rules
  std::vector<PressFigures> figures;
};

/// "x", "y" or "z".
std::string_view name(Axis axis);

}  // namespace morula::study
