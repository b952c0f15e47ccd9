// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Extremes: the few of many points that decide the size of a ball around them.
#pragma once

#include <span>

#include "generators/fit/ball_fit.hpp"
#include "generators/fit/free_space.hpp"

namespace morula::detail {

/// More points than this are thinned to every second, third, … one: corners of many patches repeat and lie close
/// together, so an even choice decides nearly as well. The final radii are computed from all points.
inline constexpr std::size_t most_candidates = 1200;

/// Points farthest out in directions spread over the sphere; all of them if they are few. In the grid's coordinates.
GroupPoints extremes(std::span<const Vec3> points, const OutsideGrid& grid);
GroupPoints extremes(std::span<const Vec3> points, const FreeSpace& space);

}  // namespace morula::detail
