// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "read/assembly.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <numbers>

namespace morula::robot {

std::vector<Movement> ball_movements(const std::string& name, const Vec3& anchor, int line) {
  std::vector<Movement> movements;
  constexpr std::array letters{"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    Vec3 axis;
    axis[static_cast<int>(i)] = 1;
    movements.push_back({.name = name + "_" + letters[i],
                         .kind = Joint::Kind::continuous,
                         .axis = axis,
                         .anchor = anchor,
                         .lower = -std::numbers::pi,
                         .upper = std::numbers::pi,
                         .line = line});
  }
  return movements;
}

std::string Assembly::fresh(std::set<std::string>& taken, const std::string& wanted) {
  std::string name = wanted;
  for (int i = 2; !taken.insert(name).second; ++i) name = fmt::format("{}_{}", wanted, i);
  return name;
}

std::size_t Assembly::add_empty_link(const std::string& wanted, int line) {
  Link link;
  link.name = fresh_link(wanted);
  link.line = line;
  robot.links.push_back(std::move(link));
  return robot.links.size() - 1;
}

void Assembly::add_joint(Joint joint) {
  robot.links[joint.child].joint = robot.joints.size();
  robot.joints.push_back(std::move(joint));
}

void Assembly::carry(std::size_t parent, std::size_t child, const RigidTransform& pose,
                     const std::vector<Movement>& movements, int line) {
  const std::string name = robot.links[child].name;
  std::size_t carrier = parent;
  RigidTransform at = pose;  // transform of the child at its reference, in the link reached so far
  Vec3 reached{};            // place of that link in the child
  for (std::size_t i = 0; i < movements.size(); ++i) {
    const Movement& m = movements[i];
    const bool last = i + 1 == movements.size() && m.anchor == Vec3{};
    Joint joint;
    joint.name = m.name;
    joint.kind = m.kind;
    joint.axis = m.axis;
    joint.lower = m.lower, joint.upper = m.upper;
    joint.range_known = m.range_known;
    joint.velocity = m.velocity, joint.effort = m.effort;
    joint.line = m.line;
    joint.parent = carrier;
    joint.origin = composed(at, {.translation = m.anchor - reached});
    if (m.reference != 0) {
      joint.origin =
          composed(joint.origin, m.kind == Joint::Kind::prismatic ? RigidTransform{.translation = -m.reference * m.axis}
                                                                  : RigidTransform::from_axis(m.axis, -m.reference));
    }
    joint.child = last ? child : add_empty_link(fmt::format("{}_{}", name, m.name), m.line);
    carrier = joint.child;
    reached = m.anchor;
    at = {};
    add_joint(std::move(joint));
  }
  if (carrier == child) return;
  Joint joint;
  joint.name = fresh_joint(name + "_fixed");
  joint.line = line;
  joint.parent = carrier;
  joint.child = child;
  joint.origin = composed(at, {.translation = Vec3{} - reached});
  add_joint(std::move(joint));
}

std::string endless_plane_note(const std::string& link, int line) {
  return fmt::format("a plane in {} (line {}) has no end and is left out: nothing covers it", link, line);
}

void note_other_shapes(const tinyxml2::XMLElement& taken, const std::string& link, std::vector<std::string>& notes) {
  if (const auto* next = taken.NextSiblingElement()) {
    notes.push_back(
        fmt::format("a <geometry> of {} (line {}) holds more than one shape: <{}> is taken, <{}> is left out", link,
                    next->GetLineNum(), taken.Name(), next->Name()));
  }
}

std::string unread_shape_note(const std::string& link, const FileError& error) {
  return fmt::format("a shape of {} that is not requested is left out: {}", link, error.what());
}

std::string_view name(Shape::Kind kind) {
  constexpr std::array names{"mesh", "box", "cylinder", "sphere", "capsule", "ellipsoid"};
  return names[static_cast<std::size_t>(kind)];
}

std::string_view name(Joint::Kind kind) {
  constexpr std::array names{"fixed", "revolute", "continuous", "prismatic", "floating", "planar"};
  return names[static_cast<std::size_t>(kind)];
}

namespace {

/// The number of directions in which the shape has extent.
int extents(const Shape& shape) {
  const auto count = [](const Vec3& v) { return (v.x != 0 ? 1 : 0) + (v.y != 0 ? 1 : 0) + (v.z != 0 ? 1 : 0); };
  switch (shape.kind) {
    case Shape::Kind::mesh:
      return count(shape.scale);
    case Shape::Kind::box:
    case Shape::Kind::ellipsoid:
      return count(shape.size);
    case Shape::Kind::sphere:
      return shape.radius > 0 ? 3 : 0;
    case Shape::Kind::cylinder:
      return (shape.radius > 0 ? 2 : 0) + (shape.length > 0 ? 1 : 0);
    case Shape::Kind::capsule:
      return shape.radius > 0 ? 3 : shape.length > 0 ? 1 : 0;
  }
  return 3;
}

}  // namespace

bool has_surface(const Shape& shape, const std::string& link, bool needed, std::vector<std::string>& notes) {
  const int count = extents(shape);
  if (needed && count == 2) {
    notes.push_back(fmt::format("a {} in {} (line {}) is flat: it is covered as a plate without thickness",
                                name(shape.kind), link, shape.line));
  }
  if (needed && count < 2) {
    notes.push_back(fmt::format("a {} of size 0 in {} (line {}) is left out", name(shape.kind), link, shape.line));
  }
  return count >= 2;
}

void require_no_mimic_circle(const Robot& robot) {
  detail::InterruptPoller poll_interrupt(1u << 14);
  for (const Joint& joint : robot.joints) {
    std::size_t steps = 0;
    for (const Joint* at = &joint; at->mimic; at = &robot.joints[at->mimic->joint]) {
      poll_interrupt();
      if (++steps > robot.joints.size()) {
        fail_at(robot.file, joint.line, fmt::format("joint {} follows itself through others", joint.name));
      }
    }
  }
}

void arrange(Robot& robot) {
  for (Link& link : robot.links) {
    if (!link.inertial || link.inertial->mass >= 0) continue;
    robot.notes.push_back(
        fmt::format("link {} (line {}) has the mass {}, which is below 0: it counts as a link without", link.name,
                    link.line, link.inertial->mass));
    link.inertial.reset();
  }
  for (std::size_t link = 0; link < robot.links.size(); ++link) {
    if (robot.links[link].joint != none) continue;
    if (robot.root != none) {
      fail_at(robot.file, robot.links[link].line,
              fmt::format("links {} and {} are both carried by no joint: a robot has one root; join them",
                          robot.links[robot.root].name, robot.links[link].name));
    }
    robot.root = link;
  }
  if (robot.root == none) fail_at(robot.file, 1, "every link is carried by another: a circle");
  std::vector<std::vector<std::size_t>> below(robot.links.size());
  for (std::size_t i = 0; i < robot.joints.size(); ++i) below[robot.joints[i].parent].push_back(i);
  std::vector<std::size_t> waiting(below[robot.root].rbegin(), below[robot.root].rend());
  while (!waiting.empty()) {
    const std::size_t joint = waiting.back();
    waiting.pop_back();
    robot.order.push_back(joint);
    const auto& next = below[robot.joints[joint].child];
    waiting.insert(waiting.end(), next.rbegin(), next.rend());
  }
  if (robot.order.size() != robot.joints.size()) {
    std::vector<bool> met(robot.joints.size());
    for (const std::size_t joint : robot.order) met[joint] = true;
    const auto lost = static_cast<std::size_t>(std::find(met.begin(), met.end(), false) - met.begin());
    fail_at(robot.file, robot.joints[lost].line,
            fmt::format("joint {} is part of a circle of links: a robot is a tree", robot.joints[lost].name));
  }
  for (const std::size_t joint : robot.order) {
    if (robot.joints[joint].moves() && !robot.joints[joint].mimic) robot.independent_joints.push_back(joint);
  }
}

}  // namespace morula::robot
