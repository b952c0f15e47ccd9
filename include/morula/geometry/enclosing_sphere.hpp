// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The smallest sphere that contains points, or spheres.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <span>

namespace morula {

/// Smallest enclosing sphere of points, by farthest-point pivoting [gartner1999].
///
/// points: any number, including duplicates and flat sets; no points give a sphere of radius 0 at the origin.
/// Result: the radius is the largest distance in double arithmetic, without a rounding pad (see rounded_up_radius).
/// Cost: O(n) per pivot, about ten pivots.
Sphere enclosing_sphere(std::span<const Vec3> points);

/// Smallest enclosing sphere of spheres, by farthest-sphere pivoting [fischer2003].
///
/// spheres: finite, with radii of at least 0; any number, including spheres inside others. No spheres give a sphere of
/// radius 0 at the origin; one sphere gives itself.
/// Result: the radius is farthest_reach(center, spheres), without a rounding pad; infinite or NaN if differences
/// overflow.
/// Cost: O(n) per pivot, about ten pivots.
Sphere enclosing_sphere_of_spheres(std::span<const Sphere> spheres);

/// Largest |center - c| + r of the spheres, accurate to a few ulps at any size; 0 for no spheres.
double farthest_reach(const Vec3& center, std::span<const Sphere> spheres);

/// Largest distance from center to a point; 0 for no points.
double farthest_distance(const Vec3& center, std::span<const Vec3> points);

}  // namespace morula
