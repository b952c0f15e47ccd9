// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Random robots of spheres, and the poses of their links by matrices.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/robot/self_collision.hpp>
#include <string>
#include <vector>

#include "random_poses.hpp"

namespace morula::test::configurations {

using Matrix = std::array<std::array<double, 4>, 4>;

inline Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
    }
  }
  return c;
}
inline Matrix matrix(const RigidTransform& t) {
  Matrix m{};
  for (std::size_t i = 0; i < 3; ++i) {
    const int k = static_cast<int>(i);
    m[i] = {t.rows[i].x, t.rows[i].y, t.rows[i].z, t.translation[k]};
  }
  m[3][3] = 1;
  return m;
}
inline Vec3 moved(const Matrix& m, const Vec3& p) {
  Vec3 r;
  for (std::size_t i = 0; i < 3; ++i) r[static_cast<int>(i)] = m[i][0] * p.x + m[i][1] * p.y + m[i][2] * p.z + m[i][3];
  return r;
}
// Rodrigues' formula.
inline Matrix turned(const Vec3& a, double angle) {
  const double c = std::cos(angle), s = std::sin(angle), v = 1 - c;
  return {{{c + a.x * a.x * v, a.x * a.y * v - a.z * s, a.x * a.z * v + a.y * s, 0},
           {a.y * a.x * v + a.z * s, c + a.y * a.y * v, a.y * a.z * v - a.x * s, 0},
           {a.z * a.x * v - a.y * s, a.z * a.y * v + a.x * s, c + a.z * a.z * v, 0},
           {0, 0, 0, 1}}};
}

/// A robot, its spheres, and its poses by other means.
struct Sample {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  robot::SelfCollision self{};
  std::vector<std::array<std::size_t, 2>> allowed{};  // a link and an obstacle whose contact does not count
  double scale = 1;

  Sample(Random& random, std::size_t links, double size, std::size_t count = 5) : scale(size) {
    for (std::size_t i = 0; i < links; ++i) {
      robot.links.emplace_back().name = "link" + std::to_string(i);
      // Every fourth link is without spheres.
      if (i % 4 != 3) {
        robot::LinkSpheres link;
        link.link = i;
        for (std::size_t k = 0; k < count; ++k)
          link.spheres.push_back({random_point(random, 0.15 * size), random.uniform(0.01, 0.06) * size});
        spheres.links.push_back(link);
      }
      if (i > 0) add_joint(random, i);
    }
    robot.root = 0;
    self.ignored.clear();
    for (std::size_t i = 0; i + 1 < links; ++i) self.ignored.push_back({i, i + 1});
  }
  void add_joint(Random& random, std::size_t child) {
    using Kind = robot::Joint::Kind;
    robot::Joint joint;
    joint.name = "joint" + std::to_string(child);
    joint.kind = std::array{Kind::revolute, Kind::continuous, Kind::prismatic, Kind::revolute, Kind::fixed}[child % 5];
    joint.parent = child - 1 - (child > 2 && random.uniform(0, 1) < 0.3 ? 1 : 0);
    joint.child = child;
    joint.origin = random_pose(random, 0.35 * scale);
    joint.axis = normalized(random_point(random, 1));
    const std::size_t number = robot.joints.size();
    if (joint.moves() && child % 6 == 0 && !robot.independent_joints.empty())
      joint.mimic = robot::Joint::Mimic{robot.independent_joints[0], -0.7, 0.1};
    robot.links[child].joint = number;
    robot.order.push_back(number);
    if (joint.moves() && !joint.mimic) robot.independent_joints.push_back(number);
    robot.joints.push_back(joint);
  }
  std::vector<double> configuration(Random& random) const { return random_values(robot, random, 0.3 * scale); }
  std::vector<Matrix> poses(std::span<const double> values, const RigidTransform& base) const {
    std::vector<Matrix> result(robot.links.size());
    result[0] = matrix(base);
    for (const robot::Joint& joint : robot.joints) {
      const auto find = [&](std::size_t j) {
        const auto& all = robot.independent_joints;
        return static_cast<std::size_t>(std::find(all.begin(), all.end(), j) - all.begin());
      };
      const auto number = static_cast<std::size_t>(&joint - robot.joints.data());
      Matrix motion = matrix({});
      if (joint.moves()) {
        const double value = joint.mimic
                                 ? joint.mimic->multiplier * values[find(joint.mimic->joint)] + joint.mimic->offset
                                 : values[find(number)];
        motion = joint.kind == robot::Joint::Kind::prismatic ? matrix({.translation = value * joint.axis})
                                                             : turned(joint.axis, value);
      }
      result[joint.child] = product(product(result[joint.parent], matrix(joint.origin)), motion);
    }
    return result;
  }
};

}  // namespace morula::test::configurations
