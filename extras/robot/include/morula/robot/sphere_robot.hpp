// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A moving robot of spheres: link poses in; spheres and collisions out, through a tree over the spheres of each link.
#pragma once

#include <morula/robot/self_collision.hpp>
#include <morula/tree/sphere_state.hpp>
#include <utility>

namespace morula::robot {

/// A solid box.
struct ObstacleBox {
  RigidTransform pose{};
  Vec3 half{};  ///< half of its edges, mesh units
};

/// Verdicts equal those of tests of every sphere: two spheres collide if their centers, in double, are no farther apart
/// than the sum of their radii. For one thread at a time; copies are independent. Poses allocate only what link_poses()
/// allocates; only the first queries allocate.
class SphereRobot {
 public:
  /// Copies the required data. Pairs of self_collision.ignored are never tested. Throws std::invalid_argument for links
  /// without spheres, and for invalid spheres.
  SphereRobot(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision = {});

  /// Poses the robot by the coordinates of a configuration: one value per joint of robot.independent_joints. Throws
  /// std::invalid_argument for another number of them.
  void set_joint_values(std::span<const double> values);
  /// Poses the robot by the poses of all links, in the robot's order. Throws std::invalid_argument for another number
  /// of them.
  void set_link_poses(std::span<const RigidTransform> link_poses);

  /// Links with spheres, ascending, as indices of robot.links.
  std::span<const std::size_t> links() const { return links_; }
  std::size_t sphere_count() const { return sphere_count_; }
  /// All spheres at the present poses, link by link in the order of links(), in their own order.
  std::vector<Sphere> spheres() const;

  /// The first two links, by their places in links(), that collide and are not ignored; no value if none do.
  std::optional<std::pair<std::size_t, std::size_t>> self_collision();
  /// True if a sphere of the robot overlaps the obstacle.
  bool collides(const Sphere& obstacle);
  bool collides(const ObstacleBox& obstacle);
  /// True if a sphere of the robot overlaps a leaf's sphere of another tree: a body's, or that of a scene of spheres
  /// (PosedSpheres, tree_from_spheres). Trees whose inner spheres contain all leaves below them, as with `nested`, are
  /// pruned; in other trees every leaf is tested.
  bool collides(const SphereState& other, const RigidTransform& transform = {});

  std::size_t sphere_tests() const { return sphere_tests_; }  ///< tests of all queries

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
