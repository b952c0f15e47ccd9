// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sample robots with spheres, for tests of the files that are written of them.
#pragma once

#include <morula/robot/output.hpp>
#include <set>
#include <string>
#include <vector>

namespace morula::test {

/// An arm with few spheres, fitted once.
struct Fitted {
  robot::Robot robot;
  robot::RobotSpheres spheres;
  robot::SelfCollision self_collision;
  robot::OutputOptions options;

  explicit Fitted(const std::string& file) : robot(robot::read_robot(file)) {
    spheres = robot::fit_spheres(
        robot, {.spheres = 3, .skip = robot.name == "arm" ? std::set<std::string>{"upper"} : std::set<std::string>{}});
    self_collision = robot::find_ignored(robot, spheres, {.samples = 50});
    options.folder = "out";
  }
  std::vector<robot::OutputFile> files(const std::string& format) const {
    return robot::output_format(format)->write({robot, spheres, self_collision, options});
  }
  std::string text(const std::string& format) const { return files(format).at(0).bytes; }
};

inline const Fitted& fitted_arm() {
  static const Fitted fitted(MORULA_ROBOTS "/arm_description/urdf/arm.urdf");
  return fitted;
}
inline const Fitted& fitted_gripper() {
  static const Fitted fitted(MORULA_ROBOTS "/gripper_description/urdf/gripper.urdf");
  return fitted;
}
}  // namespace morula::test
