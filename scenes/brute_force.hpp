// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The slow, obvious versions. Tests and benchmarks hold the fast ones against them.
#pragma once

#include <morula/query/triangle_bvh.hpp>

namespace morula::brute_force {

/// Every facet looked at. O(F).
ClosestFacetPoint closest_point(const Mesh& mesh, const Vec3& p);
std::vector<std::uint32_t> facets_touching(const Mesh& mesh, const Sphere& ball);
/// Sum of all solid angles over 4π. O(F).
double winding_number(const Mesh& mesh, const Vec3& p);
/// Share of stratified points of the ball with winding number above ½, times its volume. O(samples × F).
/// samples: rounded to the nearest cube of a whole number.
double inside_volume(const Mesh& mesh, const Sphere& ball, std::size_t samples, std::uint64_t seed = 1);

}  // namespace morula::brute_force
