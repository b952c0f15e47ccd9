// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The smallest sphere that contains points.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <span>

namespace morula {

/// Smallest enclosing sphere of points, by farthest-point pivoting [gartner1999].
///
/// points: any number, duplicates and flat sets included; none gives a sphere of radius 0 at the origin.
/// After: radius = the largest distance in double arithmetic; no rounding pad (see rounded_up_radius).
/// Cost: O(n) per pivot, about ten pivots.
Sphere enclosing_sphere(std::span<const Vec3> points);

/// Largest distance from center to a point; 0 for no points.
double farthest_distance(const Vec3& center, std::span<const Vec3> points);

}  // namespace morula
