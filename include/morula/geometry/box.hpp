// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes with sides along the axes.
#pragma once

#include <limits>
#include <morula/geometry/vector.hpp>

namespace morula {

/// The points x with lower ≤ x ≤ upper in each coordinate. A default box is empty; add() enlarges it.
struct Box {
  Vec3 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
  Vec3 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

  /// True if the box contains no point.
  constexpr bool is_empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  /// The middle of the box; not a number for a default box.
  constexpr Vec3 center() const { return (lower + upper) * 0.5; }
  /// The lengths of the sides; negative for an empty box.
  constexpr Vec3 extent() const { return upper - lower; }
  /// The distance from lower to upper; 0 for an empty box.
  double diagonal() const { return is_empty() ? 0.0 : length(extent()); }
  /// Enlarges the box to the smallest one that also contains p.
  constexpr void add(const Vec3& p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  /// Enlarges the box to the smallest one that also contains b.
  constexpr void add(const Box& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  /// The axis of the longest side: 0 for x, 1 for y, 2 for z; the lowest of equally long ones.
  constexpr int longest_axis() const {
    const Vec3 e = extent();
    return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  }
};

/// The squared distance from p to the nearest point of the box: 0 inside, infinite for a default box.
constexpr double squared_distance(const Box& b, const Vec3& p) {
  const Vec3 outside = max(max(b.lower - p, p - b.upper), Vec3{0, 0, 0});
  return squared_length(outside);
}

}  // namespace morula
