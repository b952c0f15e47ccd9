// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/motion_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/enclosing_sphere.hpp>

#include "read/xml.hpp"

namespace morula::robot {
namespace {

constexpr std::size_t branching = 4;

bool turns(const JointStep& step) {
  return step.kind == Joint::Kind::revolute || step.kind == Joint::Kind::continuous;
}
bool has_value(const JointStep& step) {
  return turns(step) || step.kind == Joint::Kind::prismatic;
}

/// The rows of `rows` × the cross product matrix of `axis`.
std::array<Vec3, 3> times_cross(const std::array<Vec3, 3>& rows, const Vec3& axis) {
  return {cross(rows[0], axis), cross(rows[1], axis), cross(rows[2], axis)};
}

MotionFrame frame_of(const JointStep& step, std::uint32_t parent, const RigidTransform& at) {
  MotionFrame frame{.parent = parent, .coordinate = step.coordinate, .factor = step.factor, .offset = step.offset};
  frame.slides = !turns(step);
  frame.axis = step.axis;
  frame.length = length(step.axis);
  if (!frame.slides) {
    // A zero axis gives no rotation, as in RigidTransform::from_axis.
    if (frame.length > 0) frame.axis = frame.axis / frame.length, frame.length = 1;
    frame.odd = times_cross(at.rows, frame.axis);
    frame.even = times_cross(frame.odd, frame.axis);
  }
  frame.fixed = at.rows;
  frame.origin = at.translation;
  return frame;
}

/// Cuts spheres into halves along the longest side of the box around their centers.
std::size_t cut(std::span<Sphere> spheres) {
  Box box;
  for (const Sphere& s : spheres) box.add(s.center);
  const int axis = box.longest_axis();
  const std::size_t half = spheres.size() / 2;
  std::nth_element(spheres.begin(), spheres.begin() + static_cast<std::ptrdiff_t>(half), spheres.end(),
                   [&](const Sphere& a, const Sphere& b) { return a.center[axis] < b.center[axis]; });
  return half;
}

}  // namespace

MotionBodies::MotionBodies(const ConfigurationQuery::Model& model) {
  struct Place {
    std::uint32_t frame = 0;
    RigidTransform at{};  // in the frame
  };
  std::vector<Place> places(model.link_names.size());
  frames.emplace_back();
  for (const JointStep& step : model.steps) {
    const Place& parent = places[step.parent];
    const RigidTransform at = composed(parent.at, step.origin);
    reach += length(step.origin.translation);
    deviation += deviation_from_rigid(step.origin);
    if (has_value(step) && step.coordinate != none) {
      places[step.child] = {static_cast<std::uint32_t>(frames.size()), {}};
      frames.push_back(frame_of(step, parent.frame, at));
      continue;
    }
    places[step.child] = {parent.frame, at};
    if (!has_value(step)) continue;
    const RigidTransform still = turns(step) ? RigidTransform::from_axis(step.axis, step.offset)
                                             : RigidTransform{.translation = step.offset * step.axis};
    reach += length(still.translation);
    places[step.child].at = composed(at, still);
  }
  double farthest = 0;
  for (const MovingSpheres& group : model.groups) {
    const Place& place = places[group.link];
    MotionBody body{.frame = place.frame, .first = static_cast<std::uint32_t>(chains.size())};
    for (std::uint32_t f = place.frame; f != 0; f = frames[f].parent) chains.push_back(f);
    body.joints = static_cast<std::uint32_t>(chains.size()) - body.first;
    std::vector<Sphere> spheres;
    for (const Sphere& s : group.spheres) {
      farthest = std::max(farthest, length(s.center) + s.radius);
      spheres.push_back(sphere_at(place.at, s));
    }
    body.root = add_tree(static_cast<std::uint32_t>(bodies.size()), spheres);
    for (std::size_t i = body.root; i < nodes.size(); ++i)
      body.spread = std::max(body.spread, distance(nodes[i].sphere.center, nodes[body.root].sphere.center));
    bodies.push_back(body);
  }
  reach += farthest;
  for (const GroupPair& pair : model.pairs) {
    MotionPair to{.a = static_cast<std::uint32_t>(pair.a), .b = static_cast<std::uint32_t>(pair.b)};
    to.joints_a = bodies[pair.a].joints, to.joints_b = bodies[pair.b].joints;
    // Joints that carry both do not move them relative to each other.
    while (to.joints_a > 0 && to.joints_b > 0 &&
           chains[bodies[pair.a].first + to.joints_a - 1] == chains[bodies[pair.b].first + to.joints_b - 1])
      --to.joints_a, --to.joints_b;
    pairs.push_back(to);
  }
}

std::uint32_t MotionBodies::add_tree(std::uint32_t body, std::vector<Sphere>& spheres) {
  const auto root = static_cast<std::uint32_t>(nodes.size());
  nodes.push_back({.body = body});
  fill(root, spheres);
  return root;
}

void MotionBodies::fill(std::uint32_t node, std::span<Sphere> spheres) {
  if (spheres.size() == 1) {
    nodes[node].sphere = spheres[0];
    return;
  }
  nodes[node].sphere = enclosing_sphere_of_spheres(spheres);
  std::vector<std::span<Sphere>> parts{spheres};
  if (spheres.size() <= branching) {
    parts.clear();
    for (std::size_t i = 0; i < spheres.size(); ++i) parts.push_back(spheres.subspan(i, 1));
  } else {
    while (parts.size() < branching) {
      std::vector<std::span<Sphere>> halves;
      for (const std::span<Sphere>& part : parts) {
        const std::size_t half = cut(part);
        halves.push_back(part.first(half)), halves.push_back(part.subspan(half));
      }
      parts = std::move(halves);
    }
  }
  const auto first = static_cast<std::uint32_t>(nodes.size());
  nodes[node].first_child = first;
  nodes[node].child_count = static_cast<std::uint32_t>(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) nodes.push_back({.body = nodes[node].body});
  for (std::size_t i = 0; i < parts.size(); ++i) {
    fill(first + static_cast<std::uint32_t>(i), parts[i]);
    // Rounding must not leave a child's sphere outside.
    const Sphere child = nodes[first + i].sphere;
    Sphere& own = nodes[node].sphere;
    own.radius = std::max(own.radius, (distance(own.center, child.center) + child.radius) * (1 + 1e-15));
  }
}

}  // namespace morula::robot
