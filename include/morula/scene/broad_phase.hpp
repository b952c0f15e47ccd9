// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Broad phase: the overlapping pairs of many boxes of which some move.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/geometry/status.hpp>
#include <span>
#include <vector>

namespace morula {

/// The numbers of two boxes that overlap; a < b.
struct BoxPair {
  std::uint32_t a, b;
  bool operator==(const BoxPair&) const = default;
  auto operator<=>(const BoxPair&) const = default;
};

/// Boxes in a dynamic tree. The tree stores each box slightly enlarged, so that a small motion does not change the
/// tree. Pairs of enlarged boxes are kept, and each update compares the pairs with a box that has moved.
///
/// Exact: pairs() are all pairs of boxes with a common point, except pairs of two static boxes. For one thread at a
/// time. Cost of an update: 5 ns per kept pair, and one or two microseconds per box that has left its enlarged box.
class BroadPhase {
 public:
  BroadPhase();
  ~BroadPhase();
  BroadPhase(BroadPhase&&) noexcept;
  BroadPhase& operator=(BroadPhase&&) noexcept;

  /// Adds a box and returns its number, the lowest free one. Static boxes form no pairs with each other; they may move
  /// nevertheless. Throws std::invalid_argument for a box that is empty or not finite.
  std::uint32_t add(const Box& box, bool is_static = false);
  /// Removes a box; its number is free after the next update(). Throws std::invalid_argument if there is no such box,
  /// such as one that was removed already.
  void remove(std::uint32_t number);
  /// Moves a box. Rejected with bad_option, and `index` the number, if there is no such box or the box is empty or not
  /// finite.
  Status move(std::uint32_t number, const Box& box);
  /// Allocates memory for so many boxes, and for so many pairs of stored, enlarged boxes. Until there are more, no call
  /// allocates. Throws std::bad_alloc, also for sizes of 2^32 and more, and then has no effect besides memory.
  void reserve(std::size_t boxes, std::size_t pairs);
  bool has(std::uint32_t number) const;
  const Box& box(std::uint32_t number) const;
  std::size_t size() const;  ///< number of boxes

  /// Brings pairs() up to date. Allocates nothing if the numbers of boxes and pairs have been reached earlier. If
  /// memory runs out (std::bad_alloc), here or in add(), nothing changes, and the call may be repeated.
  void update();
  /// The pairs of the last update, ascending.
  std::span<const BoxPair> pairs() const;
  /// Finds all boxes that have a common point with this one, ascending. The boxes count as added and moved, even
  /// without an update().
  void find(const Box& box, std::vector<std::uint32_t>& found) const;
  /// Finds the boxes that reach the half space normal . x <= offset. No such box is missed; a box that only just misses
  /// the half space may be included.
  void find_behind(const Vec3& normal, double offset, std::vector<std::uint32_t>& found) const;
  /// Finds the boxes that meet the points origin + t direction, 0 <= t <= t_end. No such box is missed; a box that the
  /// points only just miss may be included.
  void find_along(const Vec3& origin, const Vec3& direction, double t_end, std::vector<std::uint32_t>& found) const;
  /// Finds the boxes that a box meets while it moves by `motion`. No such box is missed; a box that it only just misses
  /// may be included.
  void find_along(const Box& box, const Vec3& motion, std::vector<std::uint32_t>& found) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
