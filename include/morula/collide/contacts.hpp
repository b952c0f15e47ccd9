// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Contacts of two bodies: pairs of spheres, at the leaves or at a level, at once or as far as a budget reaches; and
// whether there are any.
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
  std::uint32_t pair = 0;  ///< which pair of bodies, of a query about several
  std::uint32_t node_a = 0, node_b = 0;
  /// Both nodes are final: leaves or on the level asked for. Otherwise the budget ended before the pair was looked
  /// into; there may be any number of contacts below it, or none.
  bool finished = false;
  Vec3 point;              ///< in the world: the middle of the overlap, or of the gap, on the line of centers
  Vec3 normal;             ///< unit, in the world, from b to a; +x where the centers coincide
  double depth = 0;        ///< r_a + r_b - distance of centers, at most 2 min(r_a, r_b); minus the gap if there is one
  double lens_volume = 0;  ///< of the overlap of both spheres
  /// No common point of both regions is farther from `point`. With a margin: take any point of a's region and one of
  /// b's that are no farther apart than the margin; the middle between them is no farther from `point`. Of the current
  /// spheres, rounding included.
  double error_bound = 0;
};

/// What a contact of spheres says of the surfaces in them.
struct ContactSurface {
  /// The point nearest to Contact::point of the facets of which the node owns a part, on each body.
  SurfacePoint on_a, on_b;
  /// Unit, from b to a: between Contact::normal, where the spheres bulge with their regions, and the difference of the
  /// regions' mean normals, where a sphere stands off its region.
  Vec3 normal;
  /// How far a's region has to move along the normal, or along that of the spheres, to be apart from b's: the lesser of
  /// these two upper bounds. It leaves out what the spheres stick out of the surface, so a response is not pushed
  /// outward. 0: the regions are apart.
  double depth;
};

/// Which components (component_vertices) of one body are inside the other: where the surfaces do not cross, all of the
/// component is; else the verdict is about one of its vertices. Nothing is inside an open surface.
struct MutualContainment {
  Containment a_in_b, b_in_a;
};

/// Which pair is looked into next, when there is a budget.
enum class Priority : std::uint8_t {
  level,       ///< the coarsest, all bodies in turn: contacts become equally fine
  overlap,     ///< that of the deepest overlap, as a share of both radii
  importance,  ///< the same times the weight of the bodies
};

struct CollideOptions {
  /// Contacts at this level set of both trees; nothing: at the leaves. Below the level count of one of the trees.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< pairs this far apart count too; mesh units, finite, not negative
  Budget budget{};    ///< not negative
  Priority priority = Priority::overlap;
  // The next three need current positions of both bodies (Collider::set_positions).
  bool surfaces = false;  ///< fill Contacts::surfaces; of a budget of time the search gets half then, of pair tests all
  bool find_crossings = false;  ///< fill Contacts::crossings; on top of any budget
  bool containment = false;     ///< fill Contacts::containment; making the tests is O(F log F), once per ContactQuery
  Clock clock{};                ///< of a budget of time; none: std::chrono::steady_clock
  /// For bodies whose spheres are brought up to date only where a query goes: called before the children of a node are
  /// tested, from the thread of the query, perhaps more than once per node. True: they are current. False: they
  /// cannot be had now, and the pairs that need them stay unfinished. None: everything is current.
  std::function<bool(const Collider& collider, std::uint32_t node)> refresh_children{};
};

struct [[nodiscard]] Contacts {
  /// Every crossing of the surfaces lies in the regions of one of these pairs: the finished ones first.
  std::vector<Contact> contacts;
  /// When asked for: of the first contacts. That is all of them without a budget, else the finished ones, of a budget
  /// of time as far as it reaches. ContactQuery::surface() tells those of others.
  std::vector<ContactSurface> surfaces;
  /// With `find_crossings`: the facet pairs that really intersect, of the regions in finished contacts; when all is
  /// finished those are all there are, the same as brute force finds. Of pair of bodies i: [crossings_begin[i],
  /// crossings_begin[i + 1]), in the order of (facet_a, facet_b).
  std::vector<Crossing> crossings;
  std::vector<std::size_t> crossings_begin;
  std::vector<MutualContainment> containment;  ///< one per pair of bodies when asked for, else none
  std::size_t finished_count = 0;              ///< of contacts
  /// Nothing that was asked for was left undone: finished_count is all, and so are surfaces, crossings and containment.
  bool finished = false;
  std::size_t pair_tests = 0;  ///< done by this call
  /// Per pair of bodies: no pair is above this level set of both trees.
  std::vector<std::uint32_t> achieved_level;
};

/// Contacts of two bodies, once. What asks every frame keeps a ContactQuery, which keeps its memory.
///
/// Sound where the spheres cover (SphereState::covers): surfaces that cross, or come as near as the margin, do so
/// within a pair that is reported, with or without a budget. Order: depth-first, by the nodes of b, then of a, when
/// there is no budget; else as found, the same every time for a budget of pair tests.
///
/// Throws std::invalid_argument when the last update of a body was refused, an option is out of range, or surfaces,
/// crossings or containment are asked for without current positions.
Contacts collide(const Collider& a, const Collider& b, const CollideOptions& options = {});

/// Does a leaf sphere of a overlap a leaf sphere of b, and all spheres above them? False is a proof, whatever the
/// rounding: the surfaces have no point in common, where the spheres cover (rules exact and modal, wrapped over those,
/// or conservative). True says that they are near each other: nearer than the leaves are wide.
///
/// Surfaces: a body wholly inside another one is not an overlap by itself. Allocates nothing.
/// Throws std::invalid_argument when the last update of a body was refused.
bool overlap(const Collider& a, const Collider& b);

}  // namespace morula
