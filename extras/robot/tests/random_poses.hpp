// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Random points, poses and values of joints.
#pragma once

#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/robot/robot.hpp>
#include <vector>

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
/// A value for each independent joint: uniform in [-reach, reach] if it is prismatic, in [-3, 3] if it turns.
inline std::vector<double> random_values(const robot::Robot& robot, Random& random, double reach) {
  std::vector<double> values;
  for (const std::size_t j : robot.independent_joints) {
    const bool slides = robot.joints[j].kind == robot::Joint::Kind::prismatic;
    values.push_back(slides ? random.uniform(-reach, reach) : random.uniform(-3, 3));
  }
  return values;
}

}  // namespace morula::test
