// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scene: hundreds to thousands of bodies, their contacts under one budget, the beginning and end of touches, and
// queries by rays and shapes against all bodies.
//
//   morula::Scene scene({.budget = std::chrono::milliseconds(1)});
//   const morula::BodyId first = scene.add(a), second = scene.add(b, {.is_static = true});
//   if (const morula::SceneStatus status = scene.update(); !status) std::puts(message(status).c_str());
//   for (const morula::ScenePair& pair : scene.pairs())
//     if (pair.began) std::printf("%zu contacts\n", pair.contacts.size());
//   scene.remove(first), scene.remove(second);
#pragma once

#include <compare>
#include <cstdint>
#include <functional>
#include <memory>
#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/collide/sweep.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace morula {

namespace detail {
struct SceneState;
}

/// Identifies a body of a scene. Another body never gets the same id.
struct BodyId {
  std::uint32_t place = 0, generation = 0;  ///< place, which later bodies reuse; number of uses of the place
  bool operator==(const BodyId&) const = default;
  auto operator<=>(const BodyId&) const = default;
};

struct SceneBodyOptions {
  /// true: the body does not move. The scene reads it in the first update() after add() and after wake(). Two static
  /// bodies form no pair.
  bool is_static = false;
  /// Groups of bodies, one bit per group: a and b form a pair if category_a & mask_b and category_b & mask_a are both
  /// not 0. `category` must not be 0, because such a body could form no pair.
  std::uint32_t category = 1, mask = ~std::uint32_t{0};
  double weight = 1;            ///< factor of the importance of the body's pairs; finite, 0 or more
  std::uint64_t user_data = 0;  ///< a value of the caller's, which Scene::user_data() returns
};

struct SceneOptions {
  /// Level set whose nodes form contacts; no value: leaves form them. Trees that end above this level use their leaves.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< largest gap between spheres that counts as a contact, mesh units; finite, 0 or more
  /// Limit of the work of one update(), for all pairs together: pair tests, without those of two roots, or time from
  /// the start of the call. With a limit in pair tests the result has the same bits for any number of workers.
  Budget budget{};
  bool surfaces = false;        ///< true: fill ScenePair::surfaces; needs positions, like CollideOptions::surfaces
  bool find_crossings = false;  ///< true: fill ScenePair::crossings, whose cost no budget limits
  /// true: fill ScenePair::patches of finished pairs of bodies whose surfaces are closed, oriented and not inside out,
  /// and whose positions are current; other pairs keep contacts alone. A budget of pair tests does not limit patches.
  /// Of a budget of time the search gets half, then patches the rest, before surfaces: first pairs that had patches,
  /// then others by importance. add() and replace(), or the next update() after this is set, examine the surface of a
  /// body, in O(F log F) for F facets, once for all bodies with the same facets if it is closed.
  bool patches = false;
  std::uint32_t patch_points = 4;  ///< ContactPatchOptions::max_points, from 0 to 16
  bool patch_depths = true;        ///< ContactPatchOptions::depths
  /// Clock of a budget of time; empty: std::chrono::steady_clock. With a clock of the caller's, update() refines pairs
  /// on one thread.
  Clock clock{};
  /// Filter: returns true to keep a pair; empty keeps all. update() calls it on the caller's thread: once when two
  /// bodies come near each other, and again for all near pairs after set_masks(), set_options() and an update() that
  /// threw.
  std::function<bool(BodyId a, BodyId b)> accepts{};
};

/// Sizes for Scene::reserve(), each below 2^32.
struct SceneReserve {
  std::size_t bodies = 0;      ///< number of bodies
  std::size_t near_pairs = 0;  ///< number of pairs of bodies whose boxes overlap, before masks and filter
  std::size_t contacts = 0;    ///< number of contacts of a pair
};

/// Two bodies that touch or may touch: a pair with at least one contact. The lists are valid until the next update(),
/// remove() or reserve().
///
/// Two bodies touch if collide() with the level and margin of the scene has a contact: a pair of final nodes that, with
/// all pairs above it, overlaps or is within the margin. `touches` is false while this is not confirmed. A touch begins
/// in the update that confirms it, with a pair of final nodes. It ends in the update that refutes it, which finishes
/// the pair without a contact, or in which a body, a mask or a filter removes the pair. An update whose budget does not
/// reach the pair neither begins nor ends a touch.
struct ScenePair {
  BodyId a, b;             ///< bodies of the pair; a has the lower place
  std::uint64_t id = 0;    ///< number of this touch from its beginning to its end; no other touch gets it; 0: no touch
  bool touches = false;    ///< true: the touch has begun and not ended; false: undecided
  bool confirmed = false;  ///< true: the bodies touch at their present poses; false: the budget left that open
  bool began = false;      ///< true: the touch began in the last update() that was neither rejected nor threw
  bool finished = false;   ///< true: all contacts are final; false: below some contacts there may be several, or none
  std::span<const Contact> contacts{};  ///< contacts of the pair; Contact::pair is 0
  /// Surfaces of contacts, as in Contacts::surfaces; empty unless SceneOptions::surfaces is set.
  std::span<const ContactSurface> surfaces{};
  /// Crossings of finished contacts, as in Contacts::crossings; empty unless SceneOptions::find_crossings is set.
  std::span<const Crossing> crossings{};
  /// true: `patches` are all parts of the overlap of the bodies at their present poses whose surfaces cross. false: the
  /// pair has no patches, and `contacts` bound its crossings; see SceneOptions::patches.
  bool has_patches = false;
  /// Patches, as in ContactPatchQuery::patches(); empty unless SceneOptions::patches is set. Their ids stay while the
  /// bodies of the pair are near each other.
  std::span<const ContactPatch> patches{};
};

/// A touch that ended in the last update(): the bodies are apart, a body was removed, or masks or the filter part them.
struct EndedPair {
  BodyId a, b;
  std::uint64_t id = 0;  ///< ScenePair::id of the touch
};

/// A rejection, or the progress of the call.
struct [[nodiscard]] SceneStatus : Status {
  std::optional<BodyId> offender{};  ///< body that caused the rejection
  bool finished = false;             ///< true: all contacts are final
  std::size_t near_pairs = 0;        ///< number of pairs of bodies with overlapping boxes that masks and filter keep
  std::size_t open_pairs = 0;        ///< number of these pairs that are not finished
  /// Number of these pairs for which the budget left open whether the bodies touch at their present poses. For
  /// each, at most one event, the beginning or the end of a touch, is still to be reported; all other events are
  /// reported. 0 without a budget.
  std::size_t undecided_pairs = 0;
  std::size_t pair_tests = 0;  ///< number of tests of pairs of nodes in this call, without those of two roots
  /// The least budget in pair tests with which every open pair progresses: the largest product of the branchings of
  /// both trees; 0 if no pair is open. With a smaller one such a pair keeps its coarse contacts in every update.
  std::size_t tests_to_open = 0;
};
/// The fault and its remedy as text, with the body that caused it; empty for ok.
std::string message(const SceneStatus& status);

/// The bodies that a query of a ray or a shape tests; by default all.
struct SceneFilter {
  std::uint32_t mask = ~std::uint32_t{0};  ///< groups of the bodies to query: those with category & mask not 0
  std::span<const BodyId> ignored{};       ///< bodies to leave out, in any order; an id without a body has no effect
};

/// A facet of a body that a ray hits.
struct SceneHit {
  BodyId body;
  RayPoint hit;
};

/// All hits of a ray.
struct [[nodiscard]] SceneRayHits {
  SceneStatus status;
  /// One per facet, ascending by t, then by place, then by facet; valid until the next all_hits().
  std::span<const SceneHit> hits{};
  bool certified = false;  ///< true: the spheres of all bodies looked at cover, so no hit is missed
};

struct [[nodiscard]] SceneRayHit {
  SceneStatus status;
  std::optional<BodyId> body{};     ///< body that the ray hits first; at equal t the lowest by place; no value: no hit
  std::optional<RayPoint> first{};  ///< first hit; no value if there is none
  bool certified = false;           ///< true: the spheres of all bodies looked at cover, so no hit is missed
};

/// A body that a moving shape touches first.
struct [[nodiscard]] SceneSweepHit {
  SceneStatus status;
  std::optional<BodyId> body{};       ///< first body; at equal t the lowest by place; no value: the shape passes all
  std::optional<SweepPoint> first{};  ///< first touch; no value if there is none
  bool certified = false;             ///< true: the spheres of all bodies looked at cover, so no touch is missed
};

/// The first touch of a moving shape with a body.
struct SceneSweep {
  BodyId body;
  SweepPoint first;
};

/// The first touches of a moving shape with all bodies.
struct [[nodiscard]] SceneSweepHits {
  SceneStatus status;
  /// One per body that the shape touches, ascending by t, then by place; valid until the next sweep_all().
  std::span<const SceneSweep> hits{};
  bool certified = false;  ///< true: the spheres of all bodies looked at cover, so no touch is missed
};

/// A body that a shape touches or may touch.
struct SceneTouch {
  BodyId body;
  const Touch* touch = nullptr;  ///< result for the body; valid until the next touch()
};

/// Colliders that are added and removed, rest and move, and the contacts between them.
///
/// The result misses no touch, for any budget, if the spheres of the bodies cover: if the surfaces of two bodies that
/// may form a pair cross, or come as near as the margin, the pair is in pairs(), and the crossing lies within one of
/// its contacts. Pairs that a budget does not reach have coarse contacts, at least the contact of the two roots. No
/// event is false, for any budget: a touch begins or ends only where that is proven at the present poses of the bodies.
/// Events may be late, until an update reaches the pair; SceneStatus::undecided_pairs bounds their number.
///
/// All pairs share the budget by importance: the product of the weights of both bodies, of the overlap of their roots
/// relative to their size, and of one plus the number of updates since the pair last got a share. So deep pairs come
/// first, and every pair of positive weights gets its turn. The scene keeps the front of each pair: a pair of resting
/// bodies continues from it, and so does a pair of moving bodies if that saves tests.
///
/// Callbacks (SceneOptions::accepts and clock) may throw; update() passes the exception on. The scene then keeps its
/// bodies, and has no pairs until an update() succeeds. That update computes the pairs of a new scene with these
/// bodies, and reports every touch that has stayed, begun or ended since the last successful one. Lack of memory and an
/// executor that throws have the same effect. So has a callback that moves a body of the scene: update() then returns
/// changed_during_call with the body. A callback may call has(), is_asleep(), user_data(), collider(), size() and
/// options(); the other functions throw std::logic_error with their name, and change nothing.
///
/// Only one thread may use a scene at a time; workers share the work of update(). An update allocates nothing if the
/// scene has had as many bodies and pairs, and each pair as many contacts, or reserve() has made room for them. A pair
/// frees its memory at most 64 updates after its bodies part. docs/how-to/scene.md has the memory of a pair.
class Scene {
 public:
  /// Throws std::invalid_argument, with the option, for a margin that is negative or not finite, and for a negative
  /// budget.
  explicit Scene(SceneOptions options = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  /// Sets the options for the next update(). Throws like the constructor, and then changes nothing.
  void set_options(SceneOptions options);
  const SceneOptions& options() const;
  /// Allocates memory in advance. Until the scene has more bodies, near pairs, or contacts of a pair, or an update
  /// throws, no update without a budget allocates, however bodies move; the memory stays when pairs part. Room for
  /// surfaces, if SceneOptions::surfaces is set by then, is included. Three things still allocate while they grow:
  /// fronts of pairs that a budget leaves unfinished, crossings, and the memory in which a working thread reads facets.
  /// Cost: linear. Memory: near_pairs * (1 kB + 88 bytes * contacts, and 144 bytes with surfaces). Throws
  /// std::bad_alloc, also for sizes out of range, and then has no effect besides memory.
  void reserve(const SceneReserve& sizes);

  /// Adds a body, and returns its id. The scene shares the state of the collider until remove() or replace();
  /// between updates of the scene, the caller may update and move the body. Throws std::invalid_argument for options
  /// out of range, and for a body that update() rejects.
  BodyId add(const Collider& collider, const SceneBodyOptions& options = {});
  /// Removes a body; its touches end in the next update(). This and the next four functions throw std::invalid_argument
  /// for an id without a body, such as that of a removed one.
  void remove(BodyId body);
  /// Replaces the collider of a body that keeps its id. A body with another tree needs it, such as RebuiltBody after a
  /// swap. Also throws for a body that update() rejects.
  void replace(BodyId body, const Collider& collider);
  /// Declares that the body does not move. The next update() still reads the body, so it may be moved before this
  /// call; later updates read it again after wake() or another sleep(). Its touches stay.
  void sleep(BodyId body);
  /// Ends sleep(): updates read the body again. A static body is read in the next update() alone.
  void wake(BodyId body);
  /// Sets SceneBodyOptions::category and mask of a body. Throws std::invalid_argument for a category of 0.
  void set_masks(BodyId body, std::uint32_t category, std::uint32_t mask);
  /// True if the scene has a body with this id.
  bool has(BodyId body) const;
  bool is_asleep(BodyId body) const;
  std::uint64_t user_data(BodyId body) const;
  const Collider& collider(BodyId body) const;
  /// Number of bodies.
  std::size_t size() const;

  /// Finds the bodies that are near each other, and their contacts. Call it once per frame, after bodies were updated
  /// and moved.
  ///
  /// Rejects a body with one of the codes body_not_current, body_not_complete, no_surface, positions_not_current,
  /// transform_too_far and body_replaced; SceneStatus::offender is the body, and the pairs stay as they were. The
  /// result has the same bits for any number of workers unless the budget is a time.
  SceneStatus update(Workers& workers = serial_workers());
  /// The pairs of bodies that touched or may have touched in the last update(), ascending by the place of a, then of b.
  std::span<const ScenePair> pairs() const;
  /// The touches that ended in the last update(), ascending by EndedPair::id.
  std::span<const EndedPair> ended() const;
  /// The entry of pairs() for two bodies, in any order; nullptr if they are proven not to touch.
  const ScenePair* find(BodyId a, BodyId b) const;

  /// Finds the first surface that a ray hits, among the bodies whose colliders have facets. Rejects a ray that RayQuery
  /// rejects, and returns other_frame if a body that is awake has moved since update(), or if update() has thrown. A
  /// body that sleeps or is static must stay where update() read it: hits at another place are missed.
  SceneRayHit first_hit(const Ray& ray, const SceneFilter& filter = {}) const;
  /// Finds all facets that a ray hits, as RayQuery::run_all() does for one body. Rejects like first_hit().
  SceneRayHits all_hits(const Ray& ray, const SceneFilter& filter = {});
  /// Finds the first body that a shape touches which starts at its own place and moves by `motion`, and where, as
  /// SweepQuery does for one body. The bodies stay at their present poses. A box is ConvexHull::box(). Rejects input
  /// that SweepQuery rejects, and otherwise like first_hit().
  SceneSweepHit sweep(const Sphere& shape, const Vec3& motion, const SceneFilter& filter = {}) const;
  SceneSweepHit sweep(const Capsule& shape, const Vec3& motion, const SceneFilter& filter = {}) const;
  SceneSweepHit sweep(const ConvexHull& shape, const Vec3& motion, const SceneFilter& filter = {}) const;
  /// Finds all bodies that the moving shape touches, each with its first touch, as if the others were not there.
  SceneSweepHits sweep_all(const Sphere& shape, const Vec3& motion, const SceneFilter& filter = {});
  SceneSweepHits sweep_all(const Capsule& shape, const Vec3& motion, const SceneFilter& filter = {});
  SceneSweepHits sweep_all(const ConvexHull& shape, const Vec3& motion, const SceneFilter& filter = {});
  /// Finds the bodies that a shape touches or may touch: those without Touch::proven_clear. With TouchOptions::nearest
  /// also the body nearest to the shape, at any distance; at equal distances the lowest by place. Rejects input that
  /// TouchQuery rejects, and otherwise like first_hit(); touches() then stays as it was.
  SceneStatus touch(const HalfSpace& shape, const TouchOptions& options = {}, const SceneFilter& filter = {});
  SceneStatus touch(const Sphere& shape, const TouchOptions& options = {}, const SceneFilter& filter = {});
  SceneStatus touch(const Capsule& shape, const TouchOptions& options = {}, const SceneFilter& filter = {});
  SceneStatus touch(const ConvexHull& shape, const TouchOptions& options = {}, const SceneFilter& filter = {});
  /// The result of the last touch(), ascending by place.
  std::span<const SceneTouch> touches() const;

 private:
  std::unique_ptr<detail::SceneState> state_;
};

}  // namespace morula
