// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What scenarios of planners plan with.
#pragma once

#include <morula/geometry/reproducible.hpp>
#include <morula/robot/robot.hpp>
#include <morula/robot/sphere_robot.hpp>
#include <morula/robot/world.hpp>
#include <vector>

#include "scenario.hpp"

namespace morula::bench {

/// Seven joints where a panda has them, and links of about its size.
robot::Robot arm();
/// Random boxes around it.
std::vector<robot::ObstacleBox> boxes_around(Random& random, std::size_t count);
/// A ball with waves, of about seven thousand facets, next to the arm.
Mesh rock();
/// The arm among 8 boxes and the rock, and random configurations of it.
struct ArmAmongObstacles {
  ArmAmongObstacles(std::size_t configurations, const Settings& settings);
  robot::Robot robot = arm();
  robot::RobotSpheres spheres;
  robot::SelfCollision self;
  std::vector<robot::ObstacleBox> boxes;
  Mesh mesh = rock();
  robot::World world;
  std::vector<double> values;  ///< configurations × coordinates
};
/// Clearances of so many configurations among boxes and the rock, against a plain loop.
Result run_clearance(std::size_t configurations, const Settings& settings);
/// Certified edges from the free ones of a tenth of so many configurations, in turn: up to 1 rad long, or to the next.
Result run_motions(std::size_t configurations, const Settings& settings, bool is_short);

}  // namespace morula::bench
