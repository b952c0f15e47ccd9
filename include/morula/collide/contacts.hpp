// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts of two bodies: pairs of spheres, at the leaves or at a level, complete or within a budget; and a test for
// any contact.
//
//   const morula::Contacts all = morula::collide(a, b);
//   const morula::Contacts some = morula::collide(a, b, {.budget = std::chrono::microseconds(200)});
//   for (const morula::Contact& contact : some.contacts)  // sound, however early the budget ended
//     if (contact.depth > 0) std::printf("%u %u %g\n", contact.node_a, contact.node_b, contact.depth);
//   const morula::Contacts crossing = morula::collide(a, b, {.find_crossings = true});  // with facets
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/collider.hpp>
#include <morula/collide/containment.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/geometry/triangle.hpp>
#include <optional>
#include <vector>

namespace morula {

/// A pair of nodes, one of each body, whose spheres overlap or are no farther apart than the margin.
struct Contact {
  std::uint32_t pair = 0;  ///< pair of bodies, if the query has several
  std::uint32_t node_a = 0, node_b = 0;
  /// True if both nodes are final: leaves, or nodes of the requested level. False if the budget ended before the pair
  /// was opened; any number of contacts may lie below it, or none.
  bool finished = false;
  Vec3 point;              ///< center of the overlap, or of the gap, on the line of centers; world coordinates
  Vec3 normal;             ///< unit vector from b to a, world coordinates; +x if the centers coincide
  double depth = 0;        ///< r_a + r_b - distance of centers, at most 2 min(r_a, r_b), mesh units; negative for a gap
  double lens_volume = 0;  ///< volume of the overlap of both spheres, mesh units³
  /// Bound of the error of `point`, mesh units: no common point of both regions is farther from `point`. With a margin:
  /// if a point of a's region and one of b's are no farther apart than the margin, the midpoint between them is no
  /// farther from `point`. Holds for the current spheres, including rounding.
  double error_bound = 0;
};

/// The surfaces within a contact of spheres.
struct ContactSurface {
  /// On each body, the point nearest to Contact::point among the facets that the node owns in whole or in part.
  SurfacePoint on_a, on_b;
  /// Unit vector from b to a: between Contact::normal, which fits spheres that bulge with their regions, and the
  /// difference of the regions' mean normals, which fits a sphere that stands off its region.
  Vec3 normal;
  /// Separation distance, mesh units: the distance by which a's region has to move along the normal, or along that of
  /// the spheres, to be apart from b's; the lesser of these two upper bounds. It excludes the protrusion of the
  /// spheres, so a response is not pushed outward. 0: the regions are apart.
  double depth;
};

/// Components (component_vertices) of one body inside the other. If the surfaces do not cross, the verdict holds for
/// the whole component; otherwise for one of its vertices. No point is inside an open surface.
struct MutualContainment {
  Containment a_in_b, b_in_a;
};

/// Order in which a query with a budget opens pairs.
enum class Priority : std::uint8_t {
  level,       ///< coarsest pair first, all bodies in turn: contacts become equally fine
  overlap,     ///< pair of the deepest overlap first, relative to both radii
  importance,  ///< overlap times the weight of the bodies
};

struct CollideOptions {
  /// Level set of both trees for the contacts, below the level count of one of the trees; no value: the leaves.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< largest gap that counts as a contact, mesh units; finite, not negative
  Budget budget{};    ///< limit of the work; not negative
  Priority priority = Priority::overlap;
  // The next three options need current positions of both bodies (Collider::set_positions).
  bool surfaces = false;        ///< fill Contacts::surfaces; the search then gets half of a budget of time, or all of a
                                ///< budget of pair tests
  bool find_crossings = false;  ///< fill Contacts::crossings; costs extra beyond any budget
  bool containment = false;     ///< fill Contacts::containment; its preparation costs O(F log F), once per ContactQuery
  Clock clock{};                ///< clock of a budget of time; empty: std::chrono::steady_clock
  /// Callback for bodies whose spheres are refreshed only in nodes that a query visits. It runs before the children of
  /// a node are tested, on the thread of the query, perhaps more than once per node. True: the children are current.
  /// False: they are not available, and the pairs that need them stay unfinished. Empty: all nodes are current.
  /// `collider` equals the collider of the pair; its address is another.
  std::function<bool(const Collider& collider, std::uint32_t node)> refresh_children{};
};

struct [[nodiscard]] Contacts {
  /// Every crossing of the surfaces lies in the regions of one of these pairs; finished pairs come first.
  std::vector<Contact> contacts;
  /// Surfaces of the first contacts, if requested: of all contacts without a budget; of the finished contacts with a
  /// budget, as far as a budget of time allows. ContactQuery::surface() computes those of other contacts.
  std::vector<ContactSurface> surfaces;
  /// With `find_crossings`: the pairs of facets that intersect, among the regions of finished contacts. A finished
  /// query lists all of them, the same as brute force. Pair of bodies i has [crossings_begin[i], crossings_begin[i +
  /// 1]), in the order of (facet_a, facet_b).
  std::vector<Crossing> crossings;
  std::vector<std::size_t> crossings_begin;
  std::vector<MutualContainment> containment;  ///< one per pair of bodies if requested, otherwise empty
  std::size_t finished_count = 0;              ///< number of finished contacts
  /// True if the result is complete: all contacts are finished, and surfaces, crossings and containment are filled as
  /// requested.
  bool finished = false;
  std::size_t pair_tests = 0;  ///< pair tests of this call
  /// One per pair of bodies: no pair is above this level set of both trees.
  std::vector<std::uint32_t> achieved_level;
};

/// Contacts of two bodies, once. A ContactQuery keeps its memory and suits queries in every frame.
///
/// Sound if the spheres cover (SphereState::covers): surfaces that cross, or come as near as the margin, do so within a
/// reported pair, with or without a budget. Order: without a budget depth-first, by the nodes of b, then of a; with a
/// budget in the order of the search, which is reproducible for a budget of pair tests.
///
/// Throws std::invalid_argument if the last update of a body was rejected, if an option is out of range, or if
/// surfaces, crossings or containment are requested without current positions.
Contacts collide(const Collider& a, const Collider& b, const CollideOptions& options = {});

/// True if a leaf sphere of a overlaps a leaf sphere of b, and so do all spheres above them. If the spheres cover
/// (rules exact, modal and skinned, wrapped over those, or conservative), false is a proof under any rounding: the
/// surfaces have no common point. True means that the bodies are nearer than the leaves are wide.
///
/// The test is about surfaces: a body entirely inside another one does not overlap it. Allocates nothing. Throws
/// std::invalid_argument if the last update of a body was rejected.
bool overlap(const Collider& a, const Collider& b);

}  // namespace morula
