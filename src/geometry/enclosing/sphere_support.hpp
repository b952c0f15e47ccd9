// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Smallest enclosing spheres of sets that grow.
#pragma once

#include <array>
#include <morula/geometry/sphere.hpp>

#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {

/// A smallest enclosing sphere with the points that it passes through, whose smallest enclosing sphere it is.
struct SupportedSphere {
  Sphere sphere;
  std::array<Vec3, 4> points{};
  std::size_t count = 0;  ///< number of points; 0: unknown
};

/// enclosing_sphere() with a search that begins with the sphere of some of the points, or with none. points: at least
/// one. Cost: O(n) for each point that makes the sphere grow, and once more.
SupportedSphere enclosing_sphere_from(const SupportedSphere& start, const DoublePointColumns& points);

}  // namespace morula::detail
