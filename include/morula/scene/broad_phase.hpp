// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Broad phase: which of many boxes overlap, while some of them move.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/geometry/status.hpp>
#include <span>
#include <vector>

namespace morula {

/// Two boxes that overlap, by their numbers; a < b.
struct BoxPair {
  std::uint32_t a, b;
  bool operator==(const BoxPair&) const = default;
  auto operator<=>(const BoxPair&) const = default;
};

/// Boxes in a dynamic tree. A box is kept there somewhat larger than it is, so it can move a little before the tree has
/// to know; pairs of such larger boxes are remembered, and each update compares those of which one box has moved.
///
/// Exact: pairs() are all pairs of boxes that have a point in common, but for those of two static boxes. For one thread
/// at a time. Cost of an update: 5 ns per remembered pair, a microsecond or two per box that has left its larger one.
class BroadPhase {
 public:
  BroadPhase();
  ~BroadPhase();
  BroadPhase(BroadPhase&&) noexcept;
  BroadPhase& operator=(BroadPhase&&) noexcept;

  /// Another box; its number is the lowest that is free. Static boxes form no pairs with each other; they may be moved
  /// all the same. Throws std::invalid_argument for a box that is empty or not finite.
  std::uint32_t add(const Box& box, bool is_static = false);
  /// Its number is free from the next update() on. Throws std::invalid_argument when there is no such box: one that was
  /// removed already, for instance.
  void remove(std::uint32_t number);
  /// Refused with bad_option, and `index` the number: a box that is none, or that is empty or not finite.
  Status move(std::uint32_t number, const Box& box);
  bool has(std::uint32_t number) const;
  const Box& box(std::uint32_t number) const;
  std::size_t size() const;  ///< boxes there are

  /// Brings pairs() up to date. No allocation when there have been as many boxes and pairs before. Where memory runs
  /// out (std::bad_alloc), here as in add(), nothing has changed, and the call may be made again.
  void update();
  /// As of the last update, ascending.
  std::span<const BoxPair> pairs() const;
  /// All boxes that have a point in common with this one, ascending: as they were added and moved, updated or not.
  void find(const Box& box, std::vector<std::uint32_t>& found) const;
  /// Those that reach the half space normal . x <= offset; none is left out, some that only just miss it may be there.
  void find_behind(const Vec3& normal, double offset, std::vector<std::uint32_t>& found) const;
  /// Those that the points origin + t direction, 0 <= t <= t_end, go through; none in between is left out, some that
  /// are only just missed may be there.
  void find_along(const Vec3& origin, const Vec3& direction, double t_end, std::vector<std::uint32_t>& found) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
