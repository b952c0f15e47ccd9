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

/// Which body of a scene; never given again to another one.
struct BodyId {
  std::uint32_t place = 0, generation = 0;  ///< places are used again
  bool operator==(const BodyId&) const = default;
  auto operator<=>(const BodyId&) const = default;
};

struct SceneBodyOptions {
  /// Never moves: it is looked at when it is added and by wake(). Two static bodies form no pair.
  bool is_static = false;
  /// Who may meet whom, a bit per group: a and b form a pair when category_a & mask_b and category_b & mask_a are not
  /// 0. `category` must not be 0: such a body could meet nobody.
  std::uint32_t category = 1, mask = ~std::uint32_t{0};
  double weight = 1;            ///< of its pairs' importance; finite, not negative
  std::uint64_t user_data = 0;  ///< whatever the caller wants to find again
};

struct SceneOptions {
  std::optional<std::uint32_t>
      level{};        ///< contacts at this level set; none: at the leaves, as where a tree ends above
  double margin = 0;  ///< pairs this far apart count too; mesh units, finite, not negative
  /// Of one update(), for all pairs together. In pair tests: the same bits for any number of workers; the tests of
  /// roots with roots are not counted. In time: from the call on.
  Budget budget{};
  bool surfaces = false;        ///< fill ScenePair::surfaces; needs positions, as CollideOptions::surfaces
  bool find_crossings = false;  ///< fill ScenePair::crossings; on top of any budget
  Clock clock{};  ///< of a budget of time; none: std::chrono::steady_clock. With one, workers are not used
  /// Keeps a pair when it returns true. Asked once when two bodies come near each other, from the caller's thread, and
  /// of all near pairs again after set_masks(), set_options() and an update() that threw.
  std::function<bool(BodyId a, BodyId b)> accepts{};
};

/// Two bodies in contact. Lists stay until the next update() or remove().
struct ScenePair {
  BodyId a, b;            ///< a's place is the lower one
  std::uint64_t id = 0;   ///< of this touch, from its beginning to its end; never given again
  bool began = false;     ///< in the last update() that was not refused and did not throw; else it stays
  bool finished = false;  ///< all contacts are final; else some are coarse, with any number below them, or none
  std::span<const Contact> contacts{};         ///< Contact::pair is 0
  std::span<const ContactSurface> surfaces{};  ///< when asked for: as Contacts::surfaces
  std::span<const Crossing> crossings{};       ///< when asked for: as Contacts::crossings, of finished contacts
};

/// A touch that ended in the last update(): the bodies are apart, or one of them was removed.
struct EndedPair {
  BodyId a, b;
  std::uint64_t id = 0;
};

/// Refused, or how far it came.
struct [[nodiscard]] SceneStatus : Status {
  std::optional<BodyId> offender{};  ///< what a refusal is about
  bool finished = false;             ///< every contact is final
  std::size_t near_pairs = 0;        ///< of bodies whose boxes overlap and that may meet
  std::size_t open_pairs = 0;        ///< of them, those that are not finished
  std::size_t pair_tests = 0;        ///< of nodes, done by this call
};
/// In words, with the remedy; empty for ok.
std::string message(const SceneStatus& status);

struct [[nodiscard]] SceneRayHit {
  SceneStatus status;
  std::optional<BodyId> body{};  ///< the nearest; of several at the same t the first by place
  std::optional<RayPoint> first{};
  bool certified = false;  ///< the bodies that were asked all cover
};

struct SceneTouch {
  BodyId body;
  const Touch* touch = nullptr;  ///< until the next touch()
};

/// Scene: colliders that come, go, rest and move.
///
/// Complete at every interruption: where two surfaces of bodies that may meet cross, or come as near as the margin,
/// their pair is in pairs() and the place lies within one of its contacts, however small the budget. What a budget left
/// out is there as coarse contacts, at the least that of both roots.
///
/// One budget is shared by importance: the weights of both bodies times the overlap of their roots as a share of their
/// size, which is where contacts are deepest, times one and the updates for which the pair was left out, so that none
/// waits for ever. Fronts are kept: a pair of bodies that rest goes on where it ended, one that moves is carried over
/// where that saves tests.
///
/// Callbacks (SceneOptions::accepts and clock) may throw, and update() then throws the same. Afterwards the scene has
/// its bodies, and no pairs until an update() succeeds; that one has the pairs of a new scene with these bodies, and
/// tells of every touch that has stayed, begun or ended since the last one that did. Lack of memory and an executor
/// that throws do the same. From inside a callback has(), is_asleep(), user_data(), collider(), size() and options()
/// may be called; all else throws std::logic_error, naming the method, and changes nothing. A callback that moves a
/// body of the scene leaves it without pairs as well: update() is then refused with changed_during_call, and names the
/// body.
///
/// For one thread at a time; workers share its work. No allocation when as many bodies and pairs were there before, and
/// every pair had as many contacts, unless a pair has been parted for 32 updates: it gives its memory back then.
/// docs/how-to/scene.md says what a pair holds.
class Scene {
 public:
  /// Throws std::invalid_argument, naming the option: a negative or infinite margin, a negative budget.
  explicit Scene(SceneOptions options = {});
  ~Scene();
  Scene(Scene&&) noexcept;
  Scene& operator=(Scene&&) noexcept;
  /// For the next update. Throws as the constructor does; nothing has changed then.
  void set_options(SceneOptions options);
  const SceneOptions& options() const;

  /// The collider is borrowed until remove() or replace(); the body behind it is moved and placed as always.
  /// Throws std::invalid_argument for options out of range, and for a body that was refused its last update.
  BodyId add(const Collider& collider, const SceneBodyOptions& options = {});
  /// Its touches end with the next update(). Throws std::invalid_argument when there is no such body: one that was
  /// removed already, for instance. So do the next four.
  void remove(BodyId body);
  /// Another collider for the same body, which a body with another tree needs: RebuiltBody after a swap.
  void replace(BodyId body, const Collider& collider);
  /// From now on it does not move, says the caller. The next update() looks at it for the last time, so a move just
  /// before this call counts; then it is not looked at until wake(), or until sleep() is called again. Its touches
  /// stay.
  void sleep(BodyId body);
  /// It may have moved. A static body is looked at once, in the next update().
  void wake(BodyId body);
  void set_masks(BodyId body, std::uint32_t category, std::uint32_t mask);
  bool has(BodyId body) const;
  bool is_asleep(BodyId body) const;
  std::uint64_t user_data(BodyId body) const;
  const Collider& collider(BodyId body) const;
  std::size_t size() const;

  /// Once a frame, after bodies were updated and placed: finds who is near, and brings contacts up to date.
  ///
  /// Refused, with nothing changed: body_not_current, body_not_complete, no_surface, positions_not_current and
  /// transform_too_far, with the offender. Same bits for any number of workers unless the budget is a time.
  SceneStatus update(Workers& workers = serial_workers());
  /// Bodies in contact as of the last update(), in the order of their places.
  std::span<const ScenePair> pairs() const;
  std::span<const EndedPair> ended() const;
  /// The pair of two bodies, in any order; nothing where they have no contact.
  const ScenePair* find(BodyId a, BodyId b) const;

  /// The first surface that the ray hits, of bodies with surfaces. Refused with other_frame when a body has moved
  /// since update(), or update() has thrown, and as RayQuery is.
  SceneRayHit first_hit(const Ray& ray) const;
  /// Every body that a shape touches or may touch (not Touch::proven_clear), in the order of places; `nearest` is not
  /// asked for. Refused as first_hit() is; what was found before is still there.
  SceneStatus touch(const HalfSpace& shape, const TouchOptions& options = {});
  SceneStatus touch(const Sphere& shape, const TouchOptions& options = {});
  SceneStatus touch(const Capsule& shape, const TouchOptions& options = {});
  SceneStatus touch(const ConvexHull& shape, const TouchOptions& options = {});
  std::span<const SceneTouch> touches() const;

 private:
  std::unique_ptr<detail::SceneState> state_;
};

}  // namespace morula
