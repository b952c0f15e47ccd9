// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "plan/model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <string>

#include "plan/motion_bodies.hpp"

namespace morula::robot {
namespace {

// Poses are then finite for all usable configurations.
void require_joint(bool condition, const Joint& joint, const char* what) {
  if (!condition)
    throw std::invalid_argument("ConfigurationQuery: " + std::string(what) + " of joint " + joint.name +
                                " is not finite, or beyond greatest_usable_scale");
}

JointStep step_of(const Robot& robot, std::size_t joint_index) {
  const Joint& joint = robot.joints[joint_index];
  JointStep step{.parent = joint.parent,
                 .child = joint.child,
                 .origin = exact_pose(joint.origin, "ConfigurationQuery: the origin of joint " + joint.name),
                 .kind = joint.kind,
                 .axis = joint.axis};
  require_joint(has_usable_size(joint.origin.translation), joint, "the origin");
  if (!joint.moves()) return step;
  require_joint(has_usable_size(joint.axis), joint, "the axis");
  const double largest = max_norm(step.axis);
  const int exponent = largest > 0 ? std::ilogb(largest) : 0;
  for (int k = 0; k < 3; ++k) step.scaled_axis[k] = std::ldexp(step.axis[k], -exponent);
  step.axis_length = length(step.scaled_axis);
  // A zero axis gives no rotation.
  if (!(step.axis_length > 0)) step.scaled_axis = {}, step.axis_length = 1;
  std::size_t leader = joint_index;
  for (; robot.joints[leader].mimic; leader = robot.joints[leader].mimic->joint) {
    step.offset += step.factor * robot.joints[leader].mimic->offset;
    step.factor *= robot.joints[leader].mimic->multiplier;
  }
  require_joint(has_usable_size({step.factor, step.offset, 0}), joint, "the multiplier or offset");
  const auto& independent = robot.independent_joints;
  const auto found = std::find(independent.begin(), independent.end(), leader);
  // A joint that follows one without a value stays at its offset.
  if (found == independent.end()) step.factor = 0;
  step.coordinate = found == independent.end() ? none : static_cast<std::size_t>(found - independent.begin());
  return step;
}

// The rotation by an angle about an axis, with the operations of RigidTransform::from_axis() less its scaling by powers
// of two, which changes no digit here: products of entries vanish only next to others that are much larger.
std::array<Vec3, 3> rotation_of(const JointStep& step, double angle) {
  const SinCos half = sin_cos(0.5 * angle);
  const double f = half.sin / step.axis_length, w = half.cos;
  const double x = f * step.scaled_axis.x, y = f * step.scaled_axis.y, z = f * step.scaled_axis.z;
  const double s = 2 / (w * w + x * x + y * y + z * z);
  return {Vec3{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
          Vec3{s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
          Vec3{s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
}

// Products with the operations of composed().
std::array<Vec3, 3> rotated(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b) {
  std::array<Vec3, 3> result;
  for (std::size_t i = 0; i < 3; ++i) {
    result[i] = {a[i].x * b[0].x + a[i].y * b[1].x + a[i].z * b[2].x,
                 a[i].x * b[0].y + a[i].y * b[1].y + a[i].z * b[2].y,
                 a[i].x * b[0].z + a[i].y * b[1].z + a[i].z * b[2].z};
  }
  return result;
}

// Much more than the rounding of the numbers that are compared.
double rounding_allowance(const Sphere& s) {
  return 1e-12 * (max_norm(s.center) + s.radius);
}

bool are_apart(const Sphere& a, const Sphere& b) {
  const double reach = a.radius + b.radius + rounding_allowance(a) + rounding_allowance(b);
  return squared_distance(a.center, b.center) > reach * reach;
}

bool is_beyond(const Box& box, const Sphere& s) {
  const Vec3 outside = max(max(box.lower - s.center, s.center - box.upper), Vec3{});
  const double reach = s.radius + rounding_allowance(s);
  return squared_length(outside) > reach * reach;
}

}  // namespace

bool groups_touch(const MovingSpheres& a, const RigidTransform& at_a, const MovingSpheres& b,
                  const RigidTransform& at_b) {
  const Sphere bound_b = sphere_at(at_b, b.bound);
  if (are_apart(sphere_at(at_a, a.bound), bound_b)) return false;
  for (const Sphere& s : a.spheres) {
    const Sphere p = sphere_at(at_a, s);
    if (are_apart(p, bound_b)) continue;
    for (const Sphere& t : b.spheres) {
      if (spheres_touch(p, sphere_at(at_b, t))) return true;
    }
  }
  return false;
}

bool touches_obstacle(const MovingSpheres& group, const RigidTransform& at, const Obstacle& obstacle) {
  const Sphere bound = sphere_at(at, group.bound);
  if (is_beyond(obstacle.bounds, bound) || obstacle.is_clear_of(bound)) return false;
  return std::any_of(group.spheres.begin(), group.spheres.end(), [&](const Sphere& s) {
    const Sphere ball = sphere_at(at, s);
    return !is_beyond(obstacle.bounds, ball) && obstacle.touches(ball);
  });
}

ConfigurationQuery::Model::Model(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision)
    : root(robot.root), coordinates(robot.independent_joints.size()), step_of_link(robot.links.size(), none) {
  const std::size_t links = robot.links.size();
  if (root >= links) throw std::invalid_argument("ConfigurationQuery: the robot has no root link");
  for (const Link& link : robot.links) link_names.push_back(link.name);
  for (const std::size_t joint : robot.order) {
    step_of_link[robot.joints[joint].child] = steps.size();
    steps.push_back(step_of(robot, joint));
  }
  ignored.assign(links * links, false);
  for (const IgnoredPair& pair : self_collision.ignored) {
    if (pair.a >= links || pair.b >= links)
      throw std::invalid_argument("ConfigurationQuery: an ignored pair names a link that the robot lacks");
    ignored[pair.a * links + pair.b] = ignored[pair.b * links + pair.a] = true;
  }
  for (const LinkSpheres& link : spheres.links) {
    if (link.link >= links || link.spheres.empty())
      throw std::invalid_argument("ConfigurationQuery: a link of RobotSpheres has no spheres, or the robot lacks it");
    own.push_back({.link = link.link, .spheres = link.spheres, .bound = tree_from_spheres(link.spheres).spheres[0]});
  }
  std::stable_sort(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.link < b.link; });
  arrange();
}

void ConfigurationQuery::Model::arrange() {
  groups = own;
  groups.insert(groups.end(), held.begin(), held.end());
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.link < b.link; });
  const auto may_touch = [](const MovingSpheres& a, const MovingSpheres& b) {
    return std::find(a.touching.begin(), a.touching.end(), b.link) != a.touching.end();
  };
  pairs.clear();
  for (std::size_t a = 0; a < groups.size(); ++a) {
    for (std::size_t b = a + 1; b < groups.size(); ++b) {
      const MovingSpheres &p = groups[a], &q = groups[b];
      if (p.link == q.link || may_touch(p, q) || may_touch(q, p)) continue;
      if (!p.is_held && !q.is_held && ignored[p.link * link_names.size() + q.link]) continue;
      pairs.push_back({a, b});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(), [&](const GroupPair& x, const GroupPair& y) {
    return std::pair{groups[x.a].link, groups[x.b].link} < std::pair{groups[y.a].link, groups[y.b].link};
  });
  motions = std::make_shared<const MotionBodies>(*this);
}

void ConfigurationQuery::Model::place(std::span<const double> values, std::span<RigidTransform> poses) const {
  poses[root] = base;
  for (const JointStep& step : steps) {
    const RigidTransform& parent = poses[step.parent];
    RigidTransform at{rotated(parent.rows, step.origin.rows), parent(step.origin.translation)};
    if (step.moves()) {
      const double value = (step.coordinate == none ? 0 : step.factor * values[step.coordinate]) + step.offset;
      if (step.kind == Joint::Kind::prismatic)
        at.translation = at(value * step.axis);
      else
        at.rows = rotated(at.rows, rotation_of(step, value));
    }
    poses[step.child] = at;
  }
}

ConfigurationVerdict ConfigurationQuery::Model::first_contact(std::span<const RigidTransform> poses,
                                                              const World::Data* world, bool self) const {
  ConfigurationVerdict verdict;
  const std::size_t obstacles = world != nullptr ? world->obstacles.size() : 0;
  for (const MovingSpheres& group : groups) {
    if (!verdict.is_free() && verdict.link != group.link) return verdict;
    const std::size_t end = verdict.is_free() ? obstacles : verdict.obstacle;
    for (std::size_t i = 0; i < end; ++i) {
      if (group.may_touch(i) || !touches_obstacle(group, poses[group.link], *world->obstacles[i])) continue;
      verdict.link = static_cast<std::uint32_t>(group.link);
      verdict.obstacle = static_cast<std::uint32_t>(i);
      break;
    }
  }
  if (!verdict.is_free() || !self) return verdict;
  for (const GroupPair& pair : pairs) {
    const MovingSpheres &a = groups[pair.a], &b = groups[pair.b];
    if (!groups_touch(a, poses[a.link], b, poses[b.link])) continue;
    verdict.link = static_cast<std::uint32_t>(a.link);
    verdict.other_link = static_cast<std::uint32_t>(b.link);
    return verdict;
  }
  return verdict;
}

std::size_t ConfigurationQuery::Model::link_index(std::string_view name, const char* function) const {
  const auto found = std::find(link_names.begin(), link_names.end(), name);
  if (found == link_names.end())
    throw std::invalid_argument(std::string("ConfigurationQuery::") + function + ": there is no link " +
                                std::string(name));
  return static_cast<std::size_t>(found - link_names.begin());
}

void ConfigurationQuery::Model::require_configurations(std::span<const double> configurations, std::size_t count,
                                                       const char* function) const {
  const std::string name = std::string("ConfigurationQuery::") + function;
  if (configurations.size() != count * coordinates) {
    throw std::invalid_argument(name + ": " + std::to_string(configurations.size()) + " numbers for " +
                                std::to_string(count) + " configurations of " + std::to_string(coordinates) +
                                " coordinates");
  }
  for (std::size_t i = 0; i < configurations.size(); ++i) {
    if (!(std::abs(configurations[i]) <= greatest_usable_scale)) {
      throw std::invalid_argument(name + ": coordinate " + std::to_string(i % coordinates) + " of configuration " +
                                  std::to_string(i / coordinates) + " is not a finite number of usable size");
    }
  }
}

}  // namespace morula::robot
