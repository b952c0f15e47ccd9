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

#include "collide/require.hpp"
#include "scene/pair_extras.hpp"
#include "scene/pair_front.hpp"
#include "scene/scene_body.hpp"

namespace morula::detail {

struct SceneState {
  /// Two bodies whose boxes overlap, by place. Without a front: unwanted, or the roots have not overlapped yet.
  struct Near {
    std::uint32_t a = 0, b = 0;
    PairFront* front = nullptr;
    bool is_wanted = false;
    bool is_new = false;    ///< asks the filter, and looks at the roots
    bool is_bound = false;  ///< the front is of these bodies, of these generations
    std::uint32_t generation_a = 0, generation_b = 0;
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
  SceneRayHit first_hit(const Ray& ray) const;
  SceneStatus touch(const HalfSpace& shape, const TouchOptions& options);
  SceneStatus touch(const Sphere& shape, const TouchOptions& options);
  SceneStatus touch(const Capsule& shape, const TouchOptions& options);
  SceneStatus touch(const ConvexHull& shape, const TouchOptions& options);

 private:
  template <class Shape>
  SceneStatus touch_found(const Shape& shape, const TouchOptions& options);
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
