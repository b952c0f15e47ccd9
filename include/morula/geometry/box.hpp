// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Axis-aligned boxes.
#pragma once

#include <limits>
#include <morula/geometry/vector.hpp>

namespace morula {

struct Box {
  Vec3 lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
             std::numeric_limits<double>::infinity()};
  Vec3 upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
             -std::numeric_limits<double>::infinity()};

  /// The box holds no point. A new box is empty and grows to every point and box that is added.
  constexpr bool is_empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  constexpr Vec3 center() const { return (lower + upper) * 0.5; }
  constexpr Vec3 extent() const { return upper - lower; }
  double diagonal() const { return is_empty() ? 0.0 : length(extent()); }
  constexpr void add(const Vec3& p) {
    lower = min(lower, p);
    upper = max(upper, p);
  }
  constexpr void add(const Box& b) {
    lower = min(lower, b.lower);
    upper = max(upper, b.upper);
  }
  /// Axis of the largest extent: 0, 1 or 2; the lowest of equals.
  constexpr int longest_axis() const {
    const Vec3 e = extent();
    return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  }
};

/// Squared distance from p to the box; 0 inside.
constexpr double squared_distance(const Box& b, const Vec3& p) {
  const Vec3 outside = max(max(b.lower - p, p - b.upper), Vec3{0, 0, 0});
  return squared_length(outside);
}

}  // namespace morula
