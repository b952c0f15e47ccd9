// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/robot/robot.hpp>
#include <stdexcept>
#include <string>

#include "read/xml.hpp"

namespace morula::robot {

namespace {

RigidTransform motion(const Joint& joint, double value) {
  if (joint.kind == Joint::Kind::prismatic) return {.translation = value * joint.axis};
  return RigidTransform::from_axis(joint.axis, value);
}

}  // namespace

std::vector<double> rest_values(const Robot& robot) {
  std::vector<double> values;
  for (const std::size_t i : robot.independent_joints) {
    const Joint& joint = robot.joints[i];
    values.push_back(joint.lower <= 0 && 0 <= joint.upper ? 0 : 0.5 * (joint.lower + joint.upper));
  }
  return values;
}

std::vector<RigidTransform> link_poses(const Robot& robot, std::span<const double> values) {
  if (values.size() != robot.independent_joints.size()) {
    throw std::invalid_argument("joint values: " + std::to_string(values.size()) + " for a robot with " +
                                std::to_string(robot.independent_joints.size()) +
                                " joints that move by themselves; independent_joints lists them");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]))
      throw std::invalid_argument("joint values: that of " + robot.joints[robot.independent_joints[i]].name + " is " +
                                  std::to_string(values[i]) + "; a finite number is needed");
  }
  std::vector<double> own(robot.joints.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) own[robot.independent_joints[i]] = values[i];
  const auto value_of = [&](std::size_t joint) {
    double factor = 1, offset = 0;
    for (; robot.joints[joint].mimic; joint = robot.joints[joint].mimic->joint) {
      offset += factor * robot.joints[joint].mimic->offset;
      factor *= robot.joints[joint].mimic->multiplier;
    }
    return factor * own[joint] + offset;
  };
  std::vector<RigidTransform> poses(robot.links.size());
  for (const std::size_t i : robot.order) {
    const Joint& joint = robot.joints[i];
    const RigidTransform at = composed(poses[joint.parent], joint.origin);
    poses[joint.child] = joint.moves() ? composed(at, motion(joint, value_of(i))) : at;
  }
  return poses;
}

}  // namespace morula::robot
