// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The state of a scene between two updates.
#pragma once

#include <algorithm>
#include <memory>
#include <morula/scene/broad_phase.hpp>
#include <morula/scene/scene.hpp>
#include <string_view>
#include <vector>

#include "collide/facets/leaf_surfaces.hpp"
#include "collide/require.hpp"
#include "scene/front_store.hpp"
#include "scene/pair_front.hpp"
#include "scene/pair_refinement.hpp"

namespace morula::detail {

/// The least share of two roots: roots that only just overlap have a share of 0, or by rounding less, and would wait
/// forever.
inline constexpr double least_share = 0x1p-10;

/// The stamp by which a scene sees that a body has moved, or that another collider was assigned to its own.
struct BodyStamp {
  const SphereState* pose = nullptr;
  std::uint64_t cover_id = 0, frame = 0;
  Vec3 origin{};
  RigidTransform transform{};
  bool operator==(const BodyStamp&) const = default;
};

/// A body of a scene: its collider, the data read from it, and the box that contains it.
struct SceneBody {
  std::shared_ptr<const Collider> collider{};  ///< the collider; null: there is no such body
  std::uint32_t generation = 0;
  SceneBodyOptions options{};
  bool is_asleep = false;
  bool is_falling_asleep = false;  ///< whether the next update reads it once more: it may have moved just before it
                                   ///< fell asleep
  bool is_to_be_read = false;      ///< whether the next update reads it, though it is static or asleep; it then counts
                                   ///< as moved
  bool has_moved = false;          ///< true if it has moved in this update
  BodyStamp stamp{};
  Sphere around{};  ///< the ball that the box contains
  BodySurface surface{};

  bool is_looked_at() const {
    return collider != nullptr && (is_to_be_read || is_falling_asleep || !(is_asleep || options.is_static));
  }
};

/// The data that an update reads of a body, before all bodies are known to be usable.
struct BodyRead {
  Status status{};
  bool has_moved = false;
  BodyStamp stamp{};
  Sphere around{};
};

BodyStamp stamp_of(const Collider& collider);
/// Two such balls have a point in common whenever the pair test of both roots says that they overlap or are no farther
/// apart than the margin.
Sphere ball_around(const Collider& collider, double margin);
Box box_around(const Sphere& ball);

inline SceneStatus rejection(const Status& status, std::optional<BodyId> offender = {}) {
  SceneStatus rejected{status};
  rejected.offender = offender;
  return rejected;
}

/// Two bodies whose boxes overlap, by place.
struct NearPair {
  enum class Stage : std::uint8_t {
    unasked,    ///< new: the masks and the filter are not applied yet
    unwanted,   ///< rejected by them; there is no front
    roots_due,  ///< accepted, and the roots have to be tested
    looked_at,
  };
  std::uint32_t a = 0, b = 0;
  PairFront* front = nullptr;  ///< front of an accepted pair
  Stage stage = Stage::unasked;
  std::uint32_t generation_a = 0, generation_b = 0;  ///< generations of the bodies of the front; 0: it belongs to
                                                     ///< others
};

/// All near pairs. Every update makes the lists again: list_near() makes `pairs`, then look_at_roots() makes
/// `looked_at`.
struct NearPairs {
  std::vector<NearPair> pairs, next;   ///< near pairs, ascending; `next`: memory of list_near()
  std::vector<std::size_t> looked_at;  ///< places in `pairs` whose roots may have changed
};

/// The data that an update reads of bodies, by place: read_bodies() fills it, before any other data change.
struct BodyReads {
  std::vector<BodyRead> found;
  std::vector<ColliderAsRead> as_read;  ///< bodies as read, if an update has callbacks; unmoved() compares with them
};

/// The work that the next update has to repeat for all bodies or pairs. Methods of the scene set it; an update that
/// succeeds clears it.
struct SceneRenewal {
  bool everything = false;  ///< after a change of the level or the margin, or an interrupted update, which leaves no
                            ///< pairs
  bool filter = false;      ///< after a change of masks or SceneOptions::accepts
  bool extras = false;      ///< after a change of SceneOptions::surfaces or find_crossings
};

/// The published results of an update: pairs in contact, and touches that ended. publish() fills it, at the end of an
/// update: start(), add() for each pair, finish(); then the update has succeeded, and calls commit().
class PublishedPairs {
 public:
  const std::vector<ScenePair>& pairs() const { return pairs_; }
  const std::vector<EndedPair>& ended() const { return ended_; }
  /// Clears both lists. Published touches stay, and their ends are still to be published.
  void clear() noexcept { pairs_.clear(), ended_.clear(); }
  void reserve(std::size_t pairs) {
    pairs_.reserve(pairs), ended_.reserve(pairs), reported_.reserve(pairs), next_reported_.reserve(pairs);
  }
  /// Sets the lists of a published pair, which have moved to other memory.
  void follow(std::size_t pair, std::span<const Contact> contacts, std::span<const ContactSurface> surfaces) noexcept {
    if (pair >= pairs_.size()) return;
    pairs_[pair].contacts = contacts;
    if (!pairs_[pair].surfaces.empty()) pairs_[pair].surfaces = surfaces;
  }
  void start();
  /// Adds a pair with contacts; pairs come in the order of their bodies. Sets ScenePair::touches, id and began, from
  /// `confirmed` and from the touches before: a touch stays until the pair is not added.
  void add(ScenePair pair);
  void finish();
  void commit() noexcept { reported_.swap(next_reported_); }

 private:
  std::vector<ScenePair> pairs_;
  std::vector<EndedPair> ended_;
  /// The touches that an update has published and none has ended, ascending; the list that an update makes of them.
  /// They are separate from fronts and lists, so that an update that fails loses none.
  std::vector<EndedPair> reported_, next_reported_;
  std::size_t walked_ = 0;  ///< number of touches in reported_ that precede the pairs added so far, or belong to them
  std::uint64_t next_touch_ = 1;
};

/// A body with a lower bound of its distance from a shape.
struct NearestBody {
  double bound = 0;
  std::uint32_t place = 0;
  auto operator<=>(const NearestBody&) const = default;
};

/// The results of Scene::touch(), all_hits() and sweep_all(), and memory of all queries of rays and shapes: each call
/// fills it again.
struct ShapeTouches {
  std::vector<SceneTouch> touches;
  std::vector<std::unique_ptr<TouchQuery>> queries;  ///< queries; touch i belongs to query i
  mutable std::vector<std::uint32_t> bodies;         ///< places of the bodies that the ray or shape comes near
  std::vector<SceneHit> hits;                        ///< results of Scene::all_hits()
  std::vector<RayPoint> of_body;                     ///< hits of one body
  std::vector<SceneSweep> sweeps;                    ///< results of Scene::sweep_all()
  std::vector<NearestBody> nearest;                  ///< order in which Scene::touch() looks for the nearest body
};

/// Work and memory of add_extras(): surfaces and crossings of finished pairs.
struct ExtrasWork {
  ExtrasPool pool;
  std::vector<PairFront*> due;
};

/// A scene between two updates. An update fills it in this order: read_bodies() `reads_`, then `bodies`; list_near()
/// `near` and its fronts; look_at_roots() the roots of fronts, and the work of `refinement_`; refine() contacts, then
/// surfaces and crossings, of fronts; publish() `published`.
struct SceneState {
  SceneOptions options;
  BroadPhase broad;
  std::vector<SceneBody> bodies;  ///< bodies by their numbers in the broad phase
  NearPairs near;
  FrontStore fronts;
  PublishedPairs published;
  SceneRenewal renewal;
  /// Whether a callback or a lack of memory interrupted an update: there are no pairs until an update succeeds.
  bool is_interrupted = false;
  /// True while a callback may be running.
  bool is_updating = false;
  ShapeTouches shapes;

  bool has(BodyId id) const {
    return id.place < bodies.size() && bodies[id.place].generation == id.generation &&
           bodies[id.place].collider != nullptr;
  }
  SceneBody& known(BodyId id);
  /// Throws std::logic_error with the method's name while an update is running, that is, when a callback calls the
  /// method.
  SceneState& idle(std::string_view method);
  BodyId id_of(std::uint32_t place) const { return {place, bodies[place].generation}; }
  /// Whether a query looks at the body.
  bool looks_at(std::uint32_t place, const SceneFilter& filter) const {
    // mutant scene-query-mask: `(bodies[place].options.category & filter.mask) != 0` -> `true`
    return (bodies[place].options.category & filter.mask) != 0 &&
           std::find(filter.ignored.begin(), filter.ignored.end(), id_of(place)) == filter.ignored.end();
  }
  Status usable(const Collider& collider) const;
  /// ok, or the first body that has moved since the last update.
  SceneStatus current() const;
  /// Leaves the bodies of `shapes` out that the query does not look at, and those without facets.
  void filter_bodies(const SceneFilter& filter) const;
  /// Whether the spheres of all bodies that a query looks at cover. Bodies that it does not come near count too,
  /// because they could stick out of their boxes.
  bool all_cover(const SceneFilter& filter) const;

  /// The surface of a collider, shared with a body that has the same facets. Cost: that of ClosedSurface, else linear
  /// in bodies.
  BodySurface examined(const Collider& collider) const;

  /// Unbinds all fronts of a body, which has another collider.
  void unbind(std::uint32_t place);

  SceneStatus update(Workers& workers);
  void reserve(const SceneReserve& sizes);

 private:
  void follow_lists() noexcept;
  SceneStatus read_bodies(Workers& workers);
  /// Whether an update may call functions of the caller. The check for bodies that they might move takes as long as the
  /// search for bodies that have moved.
  bool has_callbacks(const Workers& workers) const;
  /// ok, or the first body that a callback has moved since read_bodies().
  SceneStatus unmoved() const;
  SceneStatus update_once(Workers& workers);
  void start_over() noexcept;
  void list_near();
  void end(const NearPair& pair);
  void look_at_roots(Workers& workers);
  void refine(std::chrono::nanoseconds start, Workers& workers, SceneStatus& status);
  void add_extras(std::chrono::nanoseconds deadline, Workers& workers);
  void add_patches(std::chrono::nanoseconds deadline, Workers& workers);
  bool may_have_patches(const NearPair& pair);
  void find_patches(PairFront& front, std::chrono::nanoseconds deadline);
  /// The patches of a pair in its present poses; null: it has none.
  const PairPatches* patches_of(const NearPair& pair) const;
  void publish(SceneStatus& status);
  std::chrono::nanoseconds now() const;

  BodyReads reads_;
  PairRefinement refinement_;
  ExtrasWork extras_;
  std::vector<PairFront*> patches_due_;
  std::chrono::nanoseconds to_publish_{0};  ///< estimated time of the end of an update
};

}  // namespace morula::detail
