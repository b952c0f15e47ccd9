// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot of spheres that moves: it takes the pose of each configuration, and returns spheres and collisions. A tree
// over the spheres of each link makes the tests fast.
#pragma once

#include <morula/robot/self_collision.hpp>
#include <morula/tree/sphere_state.hpp>
#include <utility>

namespace morula::robot {

/// A solid box as an obstacle.
struct ObstacleBox {
  RigidTransform pose{};  ///< pose of the box, centered on its own origin, in the axes of the robot's root
  Vec3 half{};            ///< halves of the lengths of its edges, mesh units
};

/// A robot whose links are sets of spheres. Two spheres collide if the distance of their centers, computed in double,
/// is at most the sum of their radii. Results are those of tests of all spheres; the trees only avoid tests.
///
/// Poses and obstacles are in the axes of the robot's root link. Only one thread may use an object at a time; copies
/// are independent. set_joint_values() allocates what link_poses() allocates; queries allocate only while their lists
/// grow, except as noted.
class SphereRobot {
 public:
  /// Copies the required data, and poses the robot at rest (rest_values). spheres: a result of fit_spheres() for this
  /// robot. self_collision() never tests the pairs of self_collision.ignored. Throws std::invalid_argument for an entry
  /// of spheres.links without spheres, and for spheres that tree_from_spheres() rejects.
  SphereRobot(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision = {});

  /// Poses the robot by a configuration. values: one per joint of robot.independent_joints, in that order, radians or
  /// mesh units. Throws std::invalid_argument for another number of values, and for values that are not finite; the
  /// pose then stays.
  void set_joint_values(std::span<const double> values);
  /// Poses the robot by the poses of all its links, such as those of a simulator, in the order of Robot::links. Throws
  /// std::invalid_argument for another number of poses, and for poses that are not finite or reflections.
  void set_link_poses(std::span<const RigidTransform> link_poses);

  /// The links with spheres, ascending, as indices in Robot::links.
  std::span<const std::size_t> links() const { return links_; }
  std::size_t sphere_count() const { return sphere_count_; }
  /// All spheres at the present pose: link by link in the order of links(), within a link in the order of
  /// LinkSpheres::spheres.
  std::vector<Sphere> spheres() const;

  /// The first pair of links whose spheres collide, among the pairs that are not ignored, as indices in links(), not in
  /// Robot::links; no value if there is none.
  std::optional<std::pair<std::size_t, std::size_t>> self_collision();
  /// True if a sphere of the robot touches or overlaps the obstacle, which is in the axes of the root link. Throws
  /// std::invalid_argument for an obstacle that is not finite, or of negative radius or half length.
  bool collides(const Sphere& obstacle);
  bool collides(const ObstacleBox& obstacle);
  /// True if a sphere of the robot touches or overlaps the sphere of a leaf of another tree: that of a Body, or
  /// PosedSpheres over tree_from_spheres() for a scene of spheres. transform: pose of that tree. The test skips parts
  /// of the tree only if SphereState::nested is true, as for a Body with the rule `wrapped` on all inner levels;
  /// otherwise, also for PosedSpheres, it tests every leaf. Allocates a list in every call.
  bool collides(const SphereState& other, const RigidTransform& transform = {});

  /// Number of tests of spheres in all queries so far.
  std::size_t sphere_tests() const { return sphere_tests_; }

 private:
  struct LinkTree {
    SphereTree tree;
    std::vector<Sphere> spheres;  // spheres of the fit, in its order
    RigidTransform at{};
    Sphere root{};              // moved root
    std::vector<Sphere> moved;  // one moved sphere per node
    bool is_moved = false;
  };

  const std::vector<Sphere>& moved(LinkTree& link);
  bool meets_ball(const Sphere& obstacle);
  template <class Inner, class Leaf>
  bool any_leaf(const Inner& inner, const Leaf& leaf);
  bool meet(LinkTree& a, LinkTree& b);

  Robot robot_;
  std::vector<std::size_t> links_;
  std::vector<LinkTree> trees_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // tested places
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
  std::vector<Sphere> other_;
  std::size_t sphere_count_ = 0, sphere_tests_ = 0;
};

}  // namespace morula::robot
