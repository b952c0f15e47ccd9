// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A robot of spheres that moves: link poses in, spheres out, and what they meet, through a tree over each link's.
#pragma once

#include <morula/robot/self_collision.hpp>
#include <morula/tree/sphere_state.hpp>
#include <utility>

namespace morula::robot {

/// A solid box.
struct ObstacleBox {
  RigidTransform pose{};
  Vec3 half{};  ///< half its edges
};

/// Verdicts are those of testing every sphere: two spheres meet where their centers, in double, are no farther apart
/// than their radii together. One thread at a time; copies are apart from each other. Posing allocates nothing but what
/// link_poses() does, and of queries only the first ones do.
class SphereRobot {
 public:
  /// Copies what it needs. Pairs of self_collision.ignored are never tested.
  /// Throws std::invalid_argument for links without spheres, and for spheres that are none.
  SphereRobot(const Robot& robot, const RobotSpheres& spheres, const SelfCollision& self_collision = {});

  /// By the coordinates of a configuration: one value per joint of robot.independent_joints. Throws
  /// std::invalid_argument for another number of them.
  void pose(std::span<const double> values);
  /// By the poses of all links, in the robot's order. Throws std::invalid_argument for another number of them.
  void place(std::span<const RigidTransform> link_poses);

  /// Links that have spheres, ascending, as indices of robot.links.
  std::span<const std::size_t> links() const { return links_; }
  std::size_t sphere_count() const { return sphere_count_; }
  /// All spheres where they are now, link by link in the order of links(), in their own order.
  std::vector<Sphere> spheres() const;

  /// The first two links, by their places in links(), that meet although they are not ignored; nothing: none do.
  std::optional<std::pair<std::size_t, std::size_t>> self_collision();
  /// Does a sphere of the robot meet it?
  bool collides(const Sphere& obstacle);
  bool collides(const ObstacleBox& obstacle);
  /// Does a sphere of the robot meet a leaf's sphere of another tree: a body's, or that of a scene of spheres
  /// (PosedSpheres, tree_from_spheres)? Inner spheres have to contain what is below them, as those of every tree for
  /// which pose.nested holds do; of others every leaf is asked.
  bool collides(const SphereState& other, const RigidTransform& transform = {});

  std::size_t sphere_tests() const { return sphere_tests_; }  ///< of all queries so far

 private:
  struct LinkTree {
    SphereTree tree;
    std::vector<Sphere> spheres;  // of the fit, in its order
    RigidTransform at{};
    Sphere root{};              // moved
    std::vector<Sphere> moved;  // one per node
    bool is_moved = false;
  };

  const std::vector<Sphere>& moved(LinkTree& link);
  template <class Inner, class Leaf>
  bool any_leaf(const Inner& inner, const Leaf& leaf);
  bool meet(LinkTree& a, LinkTree& b);

  Robot robot_;
  std::vector<std::size_t> links_;
  std::vector<LinkTree> trees_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // places that are tested
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stack_;
  std::vector<Sphere> other_;
  std::size_t sphere_count_ = 0, sphere_tests_ = 0;
};

}  // namespace morula::robot
