// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Press: a bent body and its copy, rotated by a right angle, are pressed together by known amounts. The contacts of
// their spheres are compared with the exact triangles.
#pragma once

#include <morula/collide/crossings.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/study/plan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// The extent of a query for contacts.
struct PressQuery {
  std::size_t level = 0;
  bool leaves = false;                ///< `level` is then the tree's last level
  std::optional<std::size_t> budget;  ///< pair tests; for leaves
  /// The name: "level 1", "500 tests", "leaves".
  std::string name() const;
};

/// Inner levels, then leaves with each budget, then all leaves.
std::vector<PressQuery> press_queries(const Plan& plan);

/// The ground truth at one amount, from exact verdicts on triangles, without a tree.
struct PressTruth {
  Axis axis = Axis::x;       ///< axis about which b is rotated by a right angle, and along which it is pressed
  double amount = 0;         ///< share of the diagonal, along the axis, from the first touch
  RigidTransform transform;  ///< transform of b; a stays in place
  std::vector<Crossing> crossings;
  Vec3 normal;       ///< from b to a: the opposite of the mean outward normal of a's surface inside b
  double depth = 0;  ///< distance that b has to move against it until no facets cross, mesh units
};

/// The placement of a pressed body, the same for all trees and rules.
struct PressScene {
  std::size_t body = 0;
  std::vector<Vec3> positions;     ///< positions of both bodies, in their own frames
  double diagonal = 0;             ///< diagonal of the body at rest, mesh units
  std::vector<PressTruth> truths;  ///< axes × amounts; the shortest side of the body first
};

/// Figures of the contacts of one query at one amount. Depths are relative to the true depth; angles are in degrees.
struct PressFigures {
  Axis axis = Axis::x;
  std::size_t amount = 0;  ///< index in the plan's amounts
  std::size_t query = 0;   ///< index in press_queries
  double true_depth = 0;   ///< share of the diagonal at rest
  std::size_t pair_tests = 0;
  std::size_t contacts = 0;
  std::size_t finished = 0;
  std::size_t kept = 0;       ///< contacts with a corrected depth other than 0
  double depth_spheres = 0;   ///< largest depth
  double depth_surfaces = 0;  ///< largest corrected depth
  /// Angles of contacts' normals to the true normals there; no value without contacts, or if none is kept.
  std::optional<double> normal_spheres, normal_spheres_90;
  std::optional<double> normal_surfaces, normal_surfaces_90;
  /// Angles of the sum of normals, weighted by depth, to the true normal of all.
  std::optional<double> net_spheres, net_surfaces;
  std::size_t crossings = 0;  ///< pairs of facets that cross
  std::size_t lost = 0;       ///< crossings in the regions of no contact
  double error_bound = 0;     ///< mean error bound, share of the diagonal at rest
};

/// One tree of one body with one rule: axes × amounts × queries.
struct PressCell {
  std::size_t source = 0;  ///< index for Plan::pressed
  std::size_t rule = 0;    ///< index in Plan::press_rules
  std::vector<PressFigures> figures;
};

/// The name: "x", "y", "z" or "auto".
std::string_view name(Axis axis);

}  // namespace morula::study
