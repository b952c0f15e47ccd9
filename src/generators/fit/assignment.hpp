// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Assignment: the child that each point of a node's region belongs to, and the power cells that propose it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "generators/fit/ball_fit.hpp"
#include "generators/fit/fit_kernels.hpp"
#include "geometry/each_bit.hpp"

namespace morula::detail {

/// Hash of a number, all bits mixed.
std::uint64_t hash_mix(std::uint64_t number);

/// The ball of least power at each point. Invariant: the owners are those of the centers and squared radii in
/// last_power_; an update visits only the points that a changed ball owns or could win.
class PowerCells {
 public:
  /// points: borrowed.
  PowerCells(const GroupPoints& points, std::size_t most);

  /// squared_radii: one per ball; negative: the ball owns nothing. The first of balls with equal power owns the point.
  /// Returns false if no ball may own anything; owners() is meaningless then.
  bool update(std::span<const GroupBall> balls, std::span<const float> squared_radii);
  std::span<const std::uint32_t> owners() const { return owner_; }

 private:
  struct Power {
    Vec3f center;
    float square = std::numeric_limits<float>::quiet_NaN();  // squared radius; NaN: equal to nothing, so the ball
                                                             // counts as changed
  };
  struct Changes {
    std::vector<std::size_t> changed, members;  // balls that differ from the last update; balls that may own points
    std::vector<std::uint8_t> is_changed;
  };
  Changes note_changes(std::span<const GroupBall> balls, std::span<const float> squared_radii);
  void offer(std::size_t ball, const PointColumns& points, const PowerOwners& owners) const;
  void update_all(const Changes& changes);
  void update_changed(const Changes& changes);

  const GroupPoints& points_;
  std::vector<Power> last_power_;  // per ball
  std::vector<float> power_;       // power of the point's owner, per point
  std::vector<std::uint32_t> owner_;
};

/// Invariant: the number of points, their hash and their demand match the owners. Only set_owner() changes an owner.
class Assignment {
 public:
  /// points: borrowed. All belong to ball 0. most: number of balls, 256 at most.
  Assignment(const GroupPoints& points, std::size_t most);

  const GroupPoints& points() const { return points_; }
  const std::vector<std::uint8_t>& owners() const { return owner_; }
  std::size_t count(std::size_t ball) const { return count_[ball]; }
  bool is_used(std::size_t ball) const { return count_[ball] > 0; }
  /// Hash of the set of the ball's points; 0 if it has none.
  std::uint64_t hash(std::size_t ball) const { return hash_[ball]; }
  /// Sum of the demand of each ball's points, in ascending order of points; zeros if points have no demand.
  std::span<const float> demand();

  /// Calls visit(point) for the ball's points in ascending order.
  template <class Visit>
  void each_owned(std::size_t ball, const Visit& visit) const {
    constexpr std::size_t block = 4096;
    std::array<std::uint64_t, block / 64> bits;
    for (std::size_t begin = 0; begin < owner_.size(); begin += block) {
      const std::size_t count = std::min(block, owner_.size() - begin);
      fit_kernels().equal(owner_.data() + begin, count, static_cast<std::uint8_t>(ball), bits.data());
      each_bit(std::span(bits).first((count + 63) / 64), [&](std::size_t i) { visit(begin + i); });
    }
  }

  void set_owner(std::size_t point, std::size_t ball);
  void set_owners(std::span<const std::uint8_t> owners);
  void set_all(std::size_t ball);
  /// Each point goes to the ball of least power; see PowerCells::update. Owners stay if no ball may own anything.
  void set_by_power(std::span<const GroupBall> balls, std::span<const float> squared_radii);

 private:
  const GroupPoints& points_;
  PowerCells cells_;
  std::vector<std::uint64_t> point_hash_;
  std::vector<std::uint8_t> owner_;   // per point
  std::vector<std::uint32_t> count_;  // per ball, as are the next two
  std::vector<std::uint64_t> hash_;
  std::vector<float> demand_;
  bool demand_is_stale_ =
      true;  // true: the sums are computed again, not updated, because sums of floats depend on their order
};

}  // namespace morula::detail
