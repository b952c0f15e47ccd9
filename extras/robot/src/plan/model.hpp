// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The data of a ConfigurationQuery: joints in order, groups of spheres that move together, and the pairs to test.
#pragma once

#include <algorithm>
#include <morula/geometry/scale.hpp>
#include <morula/robot/configurations.hpp>
#include <string>
#include <vector>

#include "plan/obstacle.hpp"

namespace morula::robot {

/// One joint: poses its child link.
struct JointStep {
  std::size_t parent = 0, child = 0;  // links
  RigidTransform origin{};
  Joint::Kind kind = Joint::Kind::fixed;
  Vec3 axis{};  // unit vector in the child
  // value = factor × values[coordinate] + offset. `none`: the joint is fixed, or floating or planar at value 0.
  std::size_t coordinate = none;
  double factor = 1, offset = 0;
  Vec3 scaled_axis{};  // times a power of two
  double axis_length = 1;

  bool moves() const {
    return kind == Joint::Kind::revolute || kind == Joint::Kind::continuous || kind == Joint::Kind::prismatic;
  }
};

/// Spheres that move with one link: the link's own, or those of the object that it holds.
struct MovingSpheres {
  std::size_t link = none;
  bool is_held = false;
  std::vector<Sphere> spheres{};        // in the link's axes; at least one
  Sphere bound{};                       // contains them, with an allowance for rounding
  std::vector<std::size_t> touching{};  // of an object: links that it may touch
  std::vector<std::size_t> allowed{};   // obstacles that it may touch, ascending

  bool may_touch(std::size_t obstacle) const { return std::binary_search(allowed.begin(), allowed.end(), obstacle); }
};

/// Two groups to test against each other; the link of a precedes that of b.
struct GroupPair {
  std::size_t a = 0, b = 0;
};

struct MotionBodies;

struct ConfigurationQuery::Model {
  Model(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision);

  /// The poses of all links in the world, with the bits of link_poses() if the base is at the origin. values:
  /// `coordinates` numbers. poses: link_names.size(). Allocates nothing.
  void place(std::span<const double> values, std::span<RigidTransform> poses) const;

  /// The first contact: the lowest link that touches the world, with the lowest obstacle that it touches; otherwise the
  /// first of `pairs` that touches. Computed in double from link poses; all faster ways give the same result.
  /// world: may be null for none.
  ConfigurationVerdict first_contact(std::span<const RigidTransform> poses, const World::Data* world, bool self) const;

  /// Throws std::invalid_argument, with the name of the function, unless there are count × coordinates usable numbers.
  void require_configurations(std::span<const double> configurations, std::size_t count, const char* function) const;

  /// The index of a link. Throws std::invalid_argument, with the name of the function, if there is none of this name.
  std::size_t link_index(std::string_view name, const char* function) const;

  /// Lists the groups and pairs again after a change of `own` or `held`.
  void arrange();

  std::vector<std::string> link_names;
  std::size_t root = 0, coordinates = 0;
  RigidTransform base{};
  std::vector<JointStep> steps;           // each after the one that places its parent
  std::vector<std::size_t> step_of_link;  // index in steps; none: the root
  std::vector<bool> ignored;              // link a × link count + link b, symmetric
  std::vector<MovingSpheres> own;         // groups of links, ascending
  std::vector<MovingSpheres> held;        // groups of objects, ascending by link
  std::vector<MovingSpheres> groups;      // all, ascending by link, a link's own before its object
  std::vector<GroupPair> pairs;           // ascending by the link of a, then of b

  std::shared_ptr<const MotionBodies> motions;  // trees over the groups, for edges
};

inline Sphere sphere_at(const RigidTransform& at, const Sphere& s) {
  return {at(s.center), s.radius};
}

/// Two spheres touch, as SphereRobot defines it.
inline bool spheres_touch(const Sphere& a, const Sphere& b) {
  const double reach = a.radius + b.radius;
  return squared_distance(a.center, b.center) <= reach * reach;
}

/// True if spheres of the two groups touch at these poses of their links.
bool groups_touch(const MovingSpheres& a, const RigidTransform& at_a, const MovingSpheres& b,
                  const RigidTransform& at_b);
/// True if a sphere of the group touches the obstacle at this pose of the link.
bool touches_obstacle(const MovingSpheres& group, const RigidTransform& at, const Obstacle& obstacle);

}  // namespace morula::robot
