// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The few of many points that decide how large a ball around them must be.
#pragma once

#include <span>

#include "generators/fit/ball_fit.hpp"
#include "generators/fit/free_space.hpp"

namespace morula::detail {

/// Of more points than this every second, third, … one is looked at: corners of many patches repeat and lie close
/// together, so an even choice decides nearly as well. Radii are taken from all of them in the end.
inline constexpr std::size_t most_candidates = 1200;

/// Points farthest out in directions spread over the sphere; all of them when they are few. In the grid's coordinates.
GroupPoints extremes(std::span<const Vec3> points, const OutsideGrid& grid);
GroupPoints extremes(std::span<const Vec3> points, const FreeSpace& space);

}  // namespace morula::detail
