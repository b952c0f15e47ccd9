// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Random points and poses.
#pragma once

#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>

namespace morula::test {

/// Coordinates are uniform in [-reach, reach].
inline Vec3 random_point(Random& random, double reach) {
  const double x = random.uniform(-reach, reach), y = random.uniform(-reach, reach);
  return {x, y, random.uniform(-reach, reach)};
}
/// A random rotation, and a random_point() as the translation.
inline RigidTransform random_pose(Random& random, double reach) {
  const Vec3 axis = random_point(random, 1), at = random_point(random, reach);
  return RigidTransform::from_axis(axis, random.uniform(-3, 3), at);
}

}  // namespace morula::test
