// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Obstacles of all kinds at random places, with their distances by formulas, and a robot of one sphere.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <morula/robot/robot.hpp>
#include <morula/robot/world.hpp>
#include <vector>

#include "random_poses.hpp"

namespace morula::test::configurations {

using robot::ObstacleBox;
using robot::World;
using Distance = std::function<double(const Vec3&)>;

inline double box_distance(const ObstacleBox& box, const Vec3& p) {
  const Vec3 d = p - box.pose.translation;
  double outside = 0, inside = -1e300;
  for (int k = 0; k < 3; ++k) {
    const double along = d.x * box.pose.rows[0][k] + d.y * box.pose.rows[1][k] + d.z * box.pose.rows[2][k];
    const double beyond = std::abs(along) - box.half[k];
    outside += beyond > 0 ? beyond * beyond : 0;
    inside = std::max(inside, beyond);
  }
  return outside > 0 ? std::sqrt(outside) : std::min(inside, 0.0);
}
inline Mesh centered_box(const Vec3& h) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.positions.push_back({(k & 1) != 0 ? h.x : -h.x, (k & 2) != 0 ? h.y : -h.y, (k & 4) != 0 ? h.z : -h.z});
  mesh.facets = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// A world, and distances from its obstacles by other means.
struct Scene {
  World world;
  std::vector<Distance> distances{};

  Scene() = default;
  Scene(Random& random, const Vec3& at, double size) {
    const auto pose = [&] {
      RigidTransform t = random_pose(random, 1.2 * size);
      t.translation += at;
      return t;
    };
    const auto half = [&] {
      const double x = random.uniform(0.02, 0.25), y = random.uniform(0.02, 0.25);
      return Vec3{x, y, random.uniform(0.02, 0.25)} * size;
    };
    for (int i = 0; i < 2; ++i) {
      const ObstacleBox box{pose(), half()}, solid{pose(), half()}, plate{pose(), {0.3 * size, 0.2 * size, 0}};
      add(world.add(box), [box](const Vec3& p) { return box_distance(box, p); });
      add(world.add(centered_box(solid.half), solid.pose), [solid](const Vec3& p) { return box_distance(solid, p); });
      Mesh sheet;
      for (const auto& [x, y] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}})
        sheet.positions.push_back({x * plate.half.x, y * plate.half.y, 0});
      sheet.facets = {{0, 1, 2}, {0, 2, 3}};
      add(world.add(sheet, plate.pose), [plate](const Vec3& p) { return std::abs(box_distance(plate, p)); });
      const Sphere ball{pose().translation, 0.15 * size};
      add(world.add(ball), [ball](const Vec3& p) { return distance(p, ball.center) - ball.radius; });
      const Capsule rod{pose().translation, pose().translation, 0.05 * size};
      add(world.add(rod), [rod](const Vec3& p) {
        const Vec3 along = rod.q - rod.p;
        const double t = dot(p - rod.p, along) / dot(along, along);
        return distance(p, t < 0 ? rod.p : t > 1 ? rod.q : rod.p + t * along) - rod.radius;
      });
      std::vector<Vec3> points;
      for (int k = 0; k < 200; ++k) points.push_back(at + random_point(random, 1.5 * size));
      add(world.add_points(points, 0.02 * size), [points, size](const Vec3& p) {
        double least = 1e300;
        for (const Vec3& q : points) least = std::min(least, distance(p, q));
        return least - 0.02 * size;
      });
    }
    const RigidTransform ground{.translation = at - Vec3{size, size, 0}};
    const std::vector<double> heights(12, -0.6 * size);
    add(world.add(robot::HeightField{heights, 4, 3, 0.7 * size, ground}), [at, size](const Vec3& p) {
      const Vec3 q = p - (at - Vec3{size, size, 0});
      const double deep = 1e6 * size;
      return box_distance(
          {{.translation = {1.05 * size, 0.7 * size, -0.6 * size - deep}}, {1.05 * size, 0.7 * size, deep}}, q);
    });
  }
  void add(std::size_t number, const Distance& distance) {
    EXPECT_EQ(number, distances.size());
    distances.push_back(distance);
  }
};

/// One link with one sphere, which slides along x.
struct Slider {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  Slider() {
    robot.links.resize(2);
    robot.links[0].name = "rail", robot.links[1].name = "slide";
    robot.links[1].joint = 0;
    robot::Joint joint;
    joint.kind = robot::Joint::Kind::prismatic;
    joint.parent = 0, joint.child = 1;
    robot.joints = {joint};
    robot.order = robot.independent_joints = {0};
    robot.root = 0;
    robot::LinkSpheres link;
    link.link = 1;
    link.spheres = {{{0, 0, 0}, 0.25}};
    spheres.links = {link};
  }
};

}  // namespace morula::test::configurations
