// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a scene knows between two updates.
//
// Where a front is:
//
//   new ──> in use: Near::front ── end() ──> parted ── give_back_parted() ──> spare
//            ^  ^     │                        │                              ^  │
//            │  └─────│── the same two bodies ─┘ (others: of too many parted) │  │
//            │        └── end(), a body was removed ──────────────────────────┘  │
//            └── any two bodies ─────────────────────────────────────────────────┘
#pragma once

#include <memory>
#include <morula/scene/broad_phase.hpp>
#include <morula/scene/scene.hpp>
#include <string_view>

#include "collide/facets/leaf_surfaces.hpp"
#include "collide/require.hpp"
#include "scene/pair_front.hpp"

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

struct SceneState {
  /// Two bodies whose boxes overlap, by place.
  struct Near {
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

  SceneOptions options;
  BroadPhase broad;
  std::vector<SceneBody> bodies;                   ///< by their numbers in the broad phase
  std::vector<Near> near, next_near;               ///< ascending
  std::vector<std::unique_ptr<PairFront>> fronts;  ///< all there are
  std::vector<PairFront*> spare_fronts;
  /// Of pairs that were near: they may be so again. In the order of their bodies.
  std::vector<PairFront*> parted_fronts;
  std::vector<ScenePair> published;
  std::vector<EndedPair> ended;
  /// The touches that an update has told of and none has ended, ascending; what an update makes of them. Apart from
  /// fronts and lists, so that an update that fails loses none.
  std::vector<EndedPair> touching, next_touching;
  std::uint64_t next_touch = 1;
  bool everything_anew = false, filter_anew = false, extras_anew = false;
  /// By a callback, or for lack of memory: there are no pairs until an update succeeds.
  bool is_interrupted = false;
  /// A callback may be running.
  bool is_updating = false;

  std::vector<SceneTouch> touches;
  std::vector<std::unique_ptr<TouchQuery>> touch_queries;
  mutable std::vector<std::uint32_t> found;

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
  void end(const Near& pair);
  PairFront* front_of(BodyId a, BodyId b);
  void look_at_roots(Workers& workers);
  void refine(std::chrono::nanoseconds start, Workers& workers, SceneStatus& status);
  void refine_all(Workers& workers);
  void refine_by_tests(std::size_t tests, Workers& workers);
  void choose_by_importance(std::size_t count);
  void refine_by_time(std::chrono::nanoseconds deadline, Workers& workers);
  void note_first_round(std::int64_t spent, std::int64_t pairs);
  void add_extras(std::chrono::nanoseconds deadline, Workers& workers);
  void follow_shares(Workers& workers);
  void give_back_parted();
  void publish(SceneStatus& status);
  std::chrono::nanoseconds now() const;

  /// Pairs with work to do, and what a round gives them.
  std::vector<PairFront*> work_, chosen_;
  std::vector<std::size_t> used_, shares_;
  std::vector<std::uint32_t> order_;
  std::vector<std::size_t> looked_at_;
  std::vector<std::uint32_t> places_;
  ExtrasPool extras_;
  std::size_t next_to_forget_ = 0;
  std::uint32_t updates_to_give_back_ = 0;  ///< since memory was given back last
  std::size_t tests_done_ = 0;
  std::vector<BodyRead> read_;
  std::vector<ColliderAsRead> as_read_;  ///< by place, where an update has callbacks
  std::vector<double> values_;
  double first_round_of_pair_ = 0;          ///< in the last update, of one thread; ns
  std::chrono::nanoseconds to_publish_{0};  ///< what the end of an update takes
};

}  // namespace morula::detail
