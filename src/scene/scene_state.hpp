// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a scene knows between two updates.
#pragma once

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

/// What tells whether a body has moved.
struct BodyStamp {
  std::uint64_t cover_id = 0, frame = 0;
  Vec3 origin{};
  RigidTransform transform{};
  bool operator==(const BodyStamp&) const = default;
};

/// A body of a scene: its collider, what was read of it, and the box that it lies in.
struct SceneBody {
  const Collider* collider = nullptr;  ///< none: there is no such body
  std::uint32_t generation = 0;
  SceneBodyOptions options{};
  bool is_asleep = false;
  bool is_falling_asleep = false;  ///< looked at once more in the next update: its last move may have come just before
  bool is_to_be_read = false;      ///< in the next update, though it is static or asleep; counts as moved then
  bool has_moved = false;          ///< in this update
  BodyStamp stamp{};
  Sphere around{};       ///< the ball that the box is around
  FacetShares shares{};  ///< of the collider, once surfaces were asked for

  bool is_looked_at() const {
    return collider != nullptr && (is_to_be_read || is_falling_asleep || !(is_asleep || options.is_static));
  }
};

/// What an update finds of a body, before it is known whether all can be used.
struct BodyRead {
  Status status{};
  bool has_moved = false;
  BodyStamp stamp{};
  Sphere around{};
};

BodyStamp stamp_of(const Collider& collider);
/// Two such balls have a point in common wherever the pair test of both roots says that they overlap or are no farther
/// apart than the margin.
Sphere ball_around(const Collider& collider, double margin);
Box box_around(const Sphere& ball);

inline SceneStatus refusal(const Status& status, std::optional<BodyId> offender = {}) {
  SceneStatus refused{status};
  refused.offender = offender;
  return refused;
}

/// Two bodies whose boxes overlap, by place.
struct NearPair {
  enum class Stage : std::uint8_t {
    unasked,    ///< new: the masks and the filter come next
    unwanted,   ///< by them; there is no front
    roots_due,  ///< wanted, and the roots are to be looked at
    looked_at,
  };
  std::uint32_t a = 0, b = 0;
  PairFront* front = nullptr;  ///< of a pair that is wanted
  Stage stage = Stage::unasked;
  std::uint32_t generation_a = 0, generation_b = 0;  ///< of these bodies the front is; 0: of others
};

/// All near pairs. Every update makes the lists anew: list_near() makes `pairs`, then look_at_roots() makes
/// `looked_at`.
struct NearPairs {
  std::vector<NearPair> pairs, next;   ///< ascending; `next`: memory of list_near()
  std::vector<std::size_t> looked_at;  ///< of pairs, where the roots may have changed
};

/// What an update finds of bodies, by place: read_bodies() fills it, before anything else changes.
struct BodyReads {
  std::vector<BodyRead> found;
  std::vector<ColliderAsRead> as_read;  ///< where an update has callbacks: unmoved() compares
};

/// What the next update has to do again for all bodies or pairs. Methods of the scene note it; an update that succeeds
/// clears it.
struct SceneRenewal {
  bool everything = false;  ///< other levels or another margin, or there are no pairs since an update was interrupted
  bool filter = false;      ///< other masks, or another SceneOptions::accepts
  bool extras = false;      ///< other SceneOptions::surfaces or find_crossings
};

/// What an update tells of: pairs in contact, and touches that ended. publish() fills it, at the end of an update:
/// start(), add() for each pair, finish(); then the update has succeeded, and calls commit().
class PublishedPairs {
 public:
  const std::vector<ScenePair>& pairs() const { return pairs_; }
  const std::vector<EndedPair>& ended() const { return ended_; }
  /// Touches that were told of stay, and are still to end.
  void clear() noexcept { pairs_.clear(), ended_.clear(); }
  void start();
  /// Pairs with contacts, in the order of their bodies. Sets ScenePair::id and began.
  void add(ScenePair pair);
  void finish();
  void commit() noexcept { told_.swap(next_told_); }

 private:
  std::vector<ScenePair> pairs_;
  std::vector<EndedPair> ended_;
  /// The touches that an update has told of and none has ended, ascending; what an update makes of them. Apart from
  /// fronts and lists, so that an update that fails loses none.
  std::vector<EndedPair> told_, next_told_;
  std::size_t walked_ = 0;  ///< so many of told_ are before the pairs added so far, or are theirs
  std::uint64_t next_touch_ = 1;
};

/// What Scene::touch() has found, and memory of all questions of rays and shapes: each call fills it anew.
struct ShapeTouches {
  std::vector<SceneTouch> touches;
  std::vector<std::unique_ptr<TouchQuery>> queries;  ///< touch i is of query i
  mutable std::vector<std::uint32_t> bodies;         ///< by place: those that the ray or shape comes near
};

/// Work and memory of add_extras(): surfaces and crossings of finished pairs.
struct ExtrasWork {
  ExtrasPool pool;
  std::vector<PairFront*> due;
  std::vector<std::uint32_t> places;  ///< of bodies whose shares are to follow
};

/// A scene between two updates. An update fills it in this order: read_bodies() `reads_`, then `bodies`; list_near()
/// `near` and its fronts; look_at_roots() the roots of fronts, and what `refinement_` has to do; refine() contacts,
/// then surfaces and crossings, of fronts; publish() `published`.
struct SceneState {
  SceneOptions options;
  BroadPhase broad;
  std::vector<SceneBody> bodies;  ///< by their numbers in the broad phase
  NearPairs near;
  FrontStore fronts;
  PublishedPairs published;
  SceneRenewal renewal;
  /// By a callback, or for lack of memory: there are no pairs until an update succeeds.
  bool is_interrupted = false;
  /// A callback may be running.
  bool is_updating = false;
  ShapeTouches shapes;

  bool has(BodyId id) const {
    return id.place < bodies.size() && bodies[id.place].generation == id.generation &&
           bodies[id.place].collider != nullptr;
  }
  SceneBody& known(BodyId id);
  /// Throws std::logic_error with the method's name while an update is running, as it is where a callback asks.
  SceneState& idle(std::string_view method);
  BodyId id_of(std::uint32_t place) const { return {place, bodies[place].generation}; }
  Status usable(const Collider& collider) const;
  /// ok, or the first body that has moved since the last update.
  SceneStatus current() const;

  SceneStatus update(Workers& workers);

 private:
  SceneStatus read_bodies(Workers& workers);
  /// May an update call functions of the caller's? To look after bodies that they might move takes as long as to look
  /// for bodies that have moved.
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
  void follow_shares(Workers& workers);
  void publish(SceneStatus& status);
  std::chrono::nanoseconds now() const;

  BodyReads reads_;
  PairRefinement refinement_;
  ExtrasWork extras_;
  std::chrono::nanoseconds to_publish_{0};  ///< what the end of an update takes
};

}  // namespace morula::detail
