// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Smallest enclosing spheres of sets that grow.
#pragma once

#include <array>
#include <morula/geometry/sphere.hpp>

#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {

/// A smallest enclosing sphere with the points that it passes through: it is that of these alone.
struct SupportedSphere {
  Sphere sphere;
  std::array<Vec3, 4> points{};
  std::size_t count = 0;  ///< 0: not known
};

/// enclosing_sphere(), whose search begins with that of some of the points, or with nothing. points: at least one.
/// Cost: O(n) for each point that the sphere has to grow for, and once more.
SupportedSphere enclosing_sphere_from(const SupportedSphere& start, const DoublePointColumns& points);

}  // namespace morula::detail
