// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Press: an experiment of the study. A bent body (a) and its copy (b), rotated by a right angle, are pressed together
// by known amounts. The contacts that queries on their spheres find are compared with the exact crossings of their
// facets.
#pragma once

#include <morula/collide/crossings.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/study/plan.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::study {

/// A query for contacts: the nodes at which it ends, and its budget.
struct PressQuery {
  std::size_t level = 0;              ///< level set of both trees at which the query ends
  bool leaves = false;                ///< true: the query ends at the leaves; `level` is then Plan::depth
  std::optional<std::size_t> budget;  ///< largest number of pair tests, for leaves only; no value: no limit
  /// The name: "level 1"; "500 tests" for leaves with a budget; "leaves" without one.
  std::string name() const;
};

/// The queries of every press, in this order: levels 1 to depth − 1, leaves with each budget of Plan::press_budgets,
/// leaves without a budget.
std::vector<PressQuery> press_queries(const Plan& plan);

/// The true contact of two bodies at one amount, computed from facets by exact tests. No tree affects it.
struct PressTruth {
  Axis axis = Axis::x;              ///< axis about which b is rotated by a right angle, and along which it is pressed
  double amount = 0;                ///< way of b along the axis past the first touch; share of PressScene::diagonal
  RigidTransform transform;         ///< transform of b; a stays in place
  std::vector<Crossing> crossings;  ///< pairs of facets of a and b that intersect
  Vec3 normal;  ///< unit vector from b to a: the opposite of the mean outward normal of a's surface inside b
  /// Distance that b has to move along −normal until no facets cross, to 1e-6 of the diagonal, mesh units; at most
  /// amount × diagonal.
  double depth = 0;
};

/// The presses of one body. They are the same for all its trees and for all rules.
struct PressScene {
  std::size_t body = 0;         ///< index in Plan::bodies
  std::vector<Vec3> positions;  ///< bent positions of a, and of b before its transform; one per vertex
  double diagonal = 0;          ///< diagonal of the bounding box of the body at rest, mesh units
  /// One entry per axis and amount: axis by axis, the shortest side of the bent body first. Axes along which the bodies
  /// pass each other are missing.
  std::vector<PressTruth> truths;
};

/// Figures of the contacts that one query finds at one amount. Largest depths are ratios to PressTruth::depth; angles
/// are in degrees.
struct PressFigures {
  Axis axis = Axis::x;
  std::size_t amount = 0;      ///< index in the plan's amounts
  std::size_t query = 0;       ///< index in press_queries
  double true_depth = 0;       ///< PressTruth::depth; share of the diagonal at rest
  std::size_t pair_tests = 0;  ///< pair tests of the query
  std::size_t contacts = 0;    ///< number of contacts
  std::size_t finished = 0;    ///< number of contacts with Contact::finished
  std::size_t kept = 0;        ///< number of contacts with ContactSurface::depth above 0
  double depth_spheres = 0;    ///< largest Contact::depth; 0 without contacts
  double depth_surfaces = 0;   ///< largest ContactSurface::depth; 0 if no contact is kept
  /// Angle between a contact's normal and the true normal near it: median and 90th percentile over contacts (spheres)
  /// and over kept contacts with their surface normals (surfaces); no value if there are none.
  std::optional<double> normal_spheres, normal_spheres_90;
  std::optional<double> normal_surfaces, normal_surfaces_90;
  /// Angle between the sum of depth × normal over the same contacts and PressTruth::normal; no value if there are none.
  std::optional<double> net_spheres, net_surfaces;
  std::size_t crossings = 0;  ///< number of pairs of facets that cross
  std::size_t lost = 0;       ///< number of these pairs that lie in the regions of no contact
  double error_bound = 0;     ///< mean Contact::error_bound; share of the diagonal at rest
};

/// The results of one tree of one body with one rule.
struct PressCell {
  std::size_t source = 0;             ///< argument of Plan::pressed
  std::size_t rule = 0;               ///< index in Plan::press_rules
  std::vector<PressFigures> figures;  ///< one per truth of the scene and query: truth by truth
};

/// The name: "x", "y", "z" or "auto".
std::string_view name(Axis axis);

}  // namespace morula::study
