// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Robots of few links, made in memory from joints and spheres.
#pragma once

#include <morula/robot/configurations.hpp>
#include <string>
#include <vector>

namespace morula::test {

/// Link 0 is the root, "link0"; each call of add() appends a joint and its link.
struct MovingRobot {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  robot::SelfCollision self;
  RigidTransform base{};

  MovingRobot() {
    robot.links.emplace_back();
    robot.links.back().name = "link0";
    robot.root = 0;
  }
  void add(std::size_t parent, robot::Joint::Kind kind, const Vec3& axis, const RigidTransform& origin,
           const std::vector<Sphere>& of_link) {
    const std::size_t joint = robot.joints.size(), link = robot.links.size();
    robot.joints.push_back({.name = "joint" + std::to_string(link),
                            .kind = kind,
                            .parent = parent,
                            .child = link,
                            .origin = origin,
                            .axis = axis});
    robot::Link child;
    child.name = "link" + std::to_string(link);
    child.joint = joint;
    robot.links.push_back(child);
    robot.order.push_back(joint);
    if (robot.joints.back().moves()) robot.independent_joints.push_back(joint);
    cover(link, of_link);
  }
  void cover(std::size_t link, const std::vector<Sphere>& of_link) {
    if (of_link.empty()) return;
    robot::LinkSpheres with;
    with.link = link;
    with.spheres = of_link;
    spheres.links.push_back(with);
  }
  robot::ConfigurationQuery query() const {
    robot::ConfigurationQuery query(robot, spheres, self);
    query.set_base(base);
    return query;
  }
};

}  // namespace morula::test
