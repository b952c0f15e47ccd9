// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The point of an intersection of half spaces that is nearest to a goal.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// The points x with normal · x ≥ offset. The normal has length 1.
struct KeptSide {
  Vec3 normal;
  double offset;
};

/// point = goal + sum of weight[k] × normal of active[k].
struct NearestKept {
  Vec3 point;
  bool exists = true;  ///< false: no point is on the kept side of all, up to the tolerance; the point is then the goal
  std::size_t active_count = 0;
  std::array<std::uint32_t, 3> active{};
  std::array<double, 3> weight{};  ///< above 0
};

/// The nearest point to the goal that lies on the kept side of all planes, up to `tolerance`. Deterministic. Cost:
/// about 0.1 us per change of the planes that hold the point, at most 64 of them.
NearestKept nearest_kept(const Vec3& goal, std::span<const KeptSide> sides, double tolerance);

}  // namespace morula::detail
