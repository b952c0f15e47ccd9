// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/pair_chain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "read/xml.hpp"

namespace morula::robot {

namespace {

/// A joint's value as a function of the coordinate that it depends on through others.
struct Dependence {
  std::size_t leader = none;  // joint
  double factor = 1, offset = 0;
};

Dependence dependence_of(const Robot& robot, std::size_t joint) {
  Dependence result;
  for (; robot.joints[joint].mimic; joint = robot.joints[joint].mimic->joint) {
    result.offset += result.factor * robot.joints[joint].mimic->offset;
    result.factor *= robot.joints[joint].mimic->multiplier;
  }
  result.leader = joint;
  return result;
}

/// The links from one to the root, itself first.
std::vector<std::size_t> links_to_root(const Robot& robot, std::size_t link) {
  std::vector<std::size_t> links{link};
  while (robot.links[link].joint != none) {
    link = robot.joints[robot.links[link].joint].parent;
    links.push_back(link);
  }
  return links;
}

RigidTransform motion(const ChainJoint& joint, double value) {
  if (joint.slides) return {.translation = value * joint.axis};
  return RigidTransform::from_axis(joint.axis, value);
}

/// Turns by a full circle or more are the circle, where no other joint follows at another rate.
CoordinateRange range_of(const Joint& joint, bool is_followed) {
  constexpr double pi = std::numbers::pi;
  const bool turns = joint.kind != Joint::Kind::prismatic;
  if (turns && !is_followed && joint.upper - joint.lower >= 2 * pi) return {-pi, pi};
  return {joint.lower, joint.upper};
}

bool is_usable(const Joint& joint, const Dependence& of, const CoordinateRange& range, double robot_size) {
  if (joint.kind == Joint::Kind::fixed) return true;
  if (!joint.moves()) return false;
  const double a = of.factor * range.lower + of.offset, b = of.factor * range.upper + of.offset;
  const double farthest = std::max(std::abs(a), std::abs(b));
  // mutant robot-pairs-absurd: `long_travel * robot_size` -> `1e30`
  return farthest <= (joint.kind == Joint::Kind::prismatic ? long_travel * robot_size : far_turn);
}

}  // namespace

JointRanges joint_ranges(const Robot& robot, double robot_size) {
  JointRanges ranges;
  ranges.coordinates.resize(robot.independent_joints.size());
  ranges.usable.assign(robot.joints.size(), true);
  std::vector<bool> is_followed(robot.joints.size(), false);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    if (robot.joints[i].mimic) is_followed[dependence_of(robot, i).leader] = true;
  }
  std::vector<CoordinateRange> of_joint(robot.joints.size());
  for (const std::size_t i : robot.independent_joints) of_joint[i] = range_of(robot.joints[i], is_followed[i]);
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const Dependence of = dependence_of(robot, i);
    const Joint& leader = robot.joints[of.leader];
    ranges.usable[i] = is_usable(robot.joints[i], of, of_joint[of.leader], robot_size) &&
                       (robot.joints[i].kind == Joint::Kind::fixed || leader.range_known);
  }
  const std::vector<double> rest = rest_values(robot);
  for (std::size_t c = 0; c < robot.independent_joints.size(); ++c) {
    const std::size_t joint = robot.independent_joints[c];
    ranges.coordinates[c] = ranges.usable[joint] ? of_joint[joint] : CoordinateRange{rest[c], rest[c]};
  }
  return ranges;
}

PairChain chain_of(const Robot& robot, const JointRanges& ranges, std::size_t link_a, std::size_t link_b) {
  std::vector<std::size_t> to_a = links_to_root(robot, link_a), to_b = links_to_root(robot, link_b);
  while (to_a.size() > 1 && to_b.size() > 1 && to_a[to_a.size() - 2] == to_b[to_b.size() - 2]) {
    to_a.pop_back();
    to_b.pop_back();
  }
  // One link may carry the other.
  PairChain chain;
  const auto coordinate_of = [&](std::size_t joint) {
    const auto own =
        static_cast<std::size_t>(std::find(robot.independent_joints.begin(), robot.independent_joints.end(), joint) -
                                 robot.independent_joints.begin());
    const auto at = std::find(chain.coordinates.begin(), chain.coordinates.end(), own);
    if (at != chain.coordinates.end()) return static_cast<std::size_t>(at - chain.coordinates.begin());
    chain.coordinates.push_back(own);
    return chain.coordinates.size() - 1;
  };
  const auto add = [&](Branch& branch, const std::vector<std::size_t>& links) {
    RigidTransform at;
    for (std::size_t i = links.size() - 1; i-- > 0;) {
      const std::size_t index = robot.links[links[i]].joint;
      const Joint& joint = robot.joints[index];
      at = composed(at, joint.origin);
      // mutant robot-pairs-range: `chain.usable && ranges.usable[index]` -> `true`
      chain.usable = chain.usable && ranges.usable[index];
      if (!joint.moves()) continue;
      const Dependence of = dependence_of(robot, index);
      if (std::find(robot.independent_joints.begin(), robot.independent_joints.end(), of.leader) ==
          robot.independent_joints.end()) {
        chain.usable = false;  // it follows a joint that does not move
        continue;
      }
      ChainJoint to{.coordinate = coordinate_of(of.leader), .factor = of.factor, .offset = of.offset};
      to.slides = joint.kind == Joint::Kind::prismatic;
      to.axis = joint.axis;
      to.before = at;
      branch.joints.push_back(to);
      at = {};
    }
    branch.end = at;
  };
  add(chain.a, to_a);
  add(chain.b, to_b);
  return chain;
}

RigidTransform place(const Branch& branch, std::span<const double> values, std::vector<PlacedJoint>& joints) {
  RigidTransform at;
  joints.clear();
  for (const ChainJoint& joint : branch.joints) {
    at = composed(at, joint.before);
    joints.push_back({at.translation, at.rotate(joint.axis), &joint});
    at = composed(at, motion(joint, joint.factor * values[joint.coordinate] + joint.offset));
  }
  return composed(at, branch.end);
}

double reach_of(const PairChain& chain, const JointRanges& ranges) {
  double sum = 0;
  for (const Branch* branch : {&chain.a, &chain.b}) {
    for (const ChainJoint& joint : branch->joints) {
      sum += length(joint.before.translation);
      if (!joint.slides) continue;
      const CoordinateRange& range = ranges.coordinates[chain.coordinates[joint.coordinate]];
      const double farthest = std::max(std::abs(range.lower), std::abs(range.upper));
      sum += length(joint.axis) * (std::abs(joint.factor) * farthest + std::abs(joint.offset));
    }
    sum += length(branch->end.translation);
  }
  return sum;
}

}  // namespace morula::robot
