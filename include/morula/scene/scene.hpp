// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scene: hundreds to thousands of bodies, their contacts under one budget, events, rays and shapes against all.
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
#include <morula/collide/contacts.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace morula {

namespace detail {
struct SceneState;
}

/// Identifies a body of a scene; never reused for another body.
struct BodyId {
  std::uint32_t place = 0, generation = 0;  ///< place, which is reused, and number of its use
  bool operator==(const BodyId&) const = default;
  auto operator<=>(const BodyId&) const = default;
};

struct SceneBodyOptions {
  /// The body never moves: the scene reads it when it is added and after wake(). Two static bodies form no pair.
  bool is_static = false;
  /// Collision groups, one bit per group: a and b form a pair if category_a & mask_b and category_b & mask_a are not 0.
  /// `category` must not be 0, because such a body could form no pair.
  std::uint32_t category = 1, mask = ~std::uint32_t{0};
  double weight = 1;            ///< factor of the importance of its pairs; finite, not negative
  std::uint64_t user_data = 0;  ///< value for the caller's own use
};

struct SceneOptions {
  /// Level set for the contacts; no value: the leaves. Trees that end above it use their leaves.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< largest gap that counts as a contact, mesh units; finite, not negative
  /// Limit of one update(), for all pairs together. In pair tests: the result has the same bits for any number of
  /// workers; tests of roots with roots are not counted. In time: from the start of the call.
  Budget budget{};
  bool surfaces = false;        ///< fill ScenePair::surfaces; needs positions, like CollideOptions::surfaces
  bool find_crossings = false;  ///< fill ScenePair::crossings; costs extra beyond any budget
  Clock clock{};  ///< clock of a budget of time; empty: std::chrono::steady_clock. A caller's clock disables
                  ///< workers
  /// Filter: returns true to keep a pair. It is called once when two bodies come near each other, on the caller's
  /// thread, and again for all near pairs after set_masks(), set_options() and an update() that threw.
  std::function<bool(BodyId a, BodyId b)> accepts{};
};

/// Two bodies in contact. The lists are valid until the next update() or remove().
struct ScenePair {
  BodyId a, b;            ///< bodies of the pair; a has the lower place
  std::uint64_t id = 0;   ///< number of this touch, from its beginning to its end; never reused
  bool began = false;     ///< the touch began in the last update() that was neither rejected nor threw
  bool finished = false;  ///< all contacts are final; false: some contacts are coarse, with any number of contacts
                          ///< below them, or none
  std::span<const Contact> contacts{};         ///< contacts of the pair; Contact::pair is 0
  std::span<const ContactSurface> surfaces{};  ///< surfaces, if requested, as in Contacts::surfaces
  std::span<const Crossing> crossings{};  ///< crossings of finished contacts, if requested, as in Contacts::crossings
};

/// A touch that ended in the last update(): the bodies have separated, or one of them was removed.
struct EndedPair {
  BodyId a, b;
  std::uint64_t id = 0;
};

/// A rejection, or the progress of the call.
struct [[nodiscard]] SceneStatus : Status {
  std::optional<BodyId> offender{};  ///< body that caused the rejection
  bool finished = false;             ///< every contact is final
  std::size_t near_pairs = 0;        ///< pairs of bodies whose boxes overlap and that may form a pair
  std::size_t open_pairs = 0;        ///< near pairs that are not finished
  std::size_t pair_tests = 0;        ///< tests of node pairs of this call
};
/// The status as text, with the remedy; empty for ok.
std::string message(const SceneStatus& status);

struct [[nodiscard]] SceneRayHit {
  SceneStatus status;
  std::optional<BodyId> body{};  ///< nearest body; of several at the same t the lowest by place
  std::optional<RayPoint> first{};
  bool certified = false;  ///< all tested bodies cover
};

struct SceneTouch {
  BodyId body;
  const Touch* touch = nullptr;  ///< result; valid until the next touch()
};

/// Scene: colliders that are added and removed, rest and move.
///
/// The result is complete at every interruption: if surfaces of two bodies that may form a pair cross, or come as near
/// as the margin, their pair is in pairs(), and the crossing lies within one of its contacts, for any budget. Pairs
/// that a budget left out are present as coarse contacts, at least as the contact of both roots.
///
/// All pairs share one budget by importance. The importance is the product of the weights of both bodies, the overlap
/// of their roots relative to their size, which is where contacts are deepest, and one plus the number of updates in
/// which the pair was left out; so every pair gets its turn. Fronts are kept: a pair of resting bodies continues from
/// its front, and the front of a moving pair is carried over if that saves tests.
///
/// Callbacks (SceneOptions::accepts and clock) may throw, and update() passes the exception on. The scene then keeps
/// its bodies, and has no pairs until an update() succeeds; that update has the pairs of a new scene with these bodies,
/// and reports every touch that has stayed, begun or ended since the last successful one. Lack of memory and an
/// executor that throws have the same effect. Inside a callback has(), is_asleep(), user_data(), collider(), size() and
/// options() may be called; all other methods throw std::logic_error, naming the method, and change nothing. A callback
/// that moves a body of the scene also leaves it without pairs: update() fails with changed_during_call and names the
/// body.
///
/// For one thread at a time; workers share its work. Allocates nothing if the scene has had as many bodies and pairs,
/// and every pair as many contacts. A pair frees its memory if its bodies stay apart for 32 updates.
/// docs/how-to/scene.md lists the memory of a pair.
class Scene {
 public:
  /// Throws std::invalid_argument, naming the option: a negative or infinite margin, a negative budget.
  explicit Scene(SceneOptions options = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  /// Sets the options of the next update. Throws like the constructor, and then changes nothing.
  void set_options(SceneOptions options);
  const SceneOptions& options() const;

  /// Adds a body. The collider is borrowed until remove() or replace(); the body behind it may be updated and moved.
  /// Throws std::invalid_argument for options out of range, and for a body whose last update was rejected.
  BodyId add(const Collider& collider, const SceneBodyOptions& options = {});
  /// Removes a body; its touches end with the next update(). This and the next four calls throw std::invalid_argument
  /// if there is no such body, such as one that was removed already.
  void remove(BodyId body);
  /// Replaces the collider of a body, which another tree requires: RebuiltBody after a swap.
  void replace(BodyId body, const Collider& collider);
  /// The caller declares that the body does not move. The next update() reads it once more, so a move just ahead of
  /// this call counts; later updates do not read it until wake(), or until sleep() is called again. Its touches stay.
  void sleep(BodyId body);
  /// Ends sleep(): the body may have moved. A static body is read once, in the next update().
  void wake(BodyId body);
  void set_masks(BodyId body, std::uint32_t category, std::uint32_t mask);
  bool has(BodyId body) const;
  bool is_asleep(BodyId body) const;
  std::uint64_t user_data(BodyId body) const;
  const Collider& collider(BodyId body) const;
  std::size_t size() const;

  /// Finds near pairs and updates contacts. Called once a frame, after bodies were updated and moved.
  ///
  /// Rejected, with no change and the offender: body_not_current, body_not_complete, no_surface, positions_not_current
  /// and transform_too_far. The result has the same bits for any number of workers unless the budget is a time.
  SceneStatus update(Workers& workers = serial_workers());
  /// Bodies in contact in the last update(), in the order of their places.
  std::span<const ScenePair> pairs() const;
  std::span<const EndedPair> ended() const;
  /// The pair of two bodies, in any order; nullptr if they have no contact.
  const ScenePair* find(BodyId a, BodyId b) const;

  /// The first surface that the ray hits, among bodies with surfaces. Rejected with other_frame if a body has moved
  /// since update(), or update() has thrown, and for the same input as RayQuery.
  SceneRayHit first_hit(const Ray& ray) const;
  /// Finds every body that a shape touches or may touch (not Touch::proven_clear), in the order of places; `nearest`
  /// has no effect. Rejected like first_hit(); the last result then stays.
  SceneStatus touch(const HalfSpace& shape, const TouchOptions& options = {});
  SceneStatus touch(const Sphere& shape, const TouchOptions& options = {});
  SceneStatus touch(const Capsule& shape, const TouchOptions& options = {});
  SceneStatus touch(const ConvexHull& shape, const TouchOptions& options = {});
  std::span<const SceneTouch> touches() const;

 private:
  std::unique_ptr<detail::SceneState> state_;
};

}  // namespace morula
