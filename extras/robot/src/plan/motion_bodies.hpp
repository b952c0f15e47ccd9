// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The data of certified edges: the joints that move, and a tree over each group of spheres that moves with one of them.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

#include "plan/model.hpp"

namespace morula::robot {

/// The axes that one joint moves. Frame 0 is that of the base, which stays. Joints without a value are folded into the
/// frames after them.
struct MotionFrame {
  std::uint32_t parent = 0;
  std::size_t coordinate = 0;
  double factor = 0, offset = 0;  ///< value = factor × coordinate + offset
  bool slides = false;
  Vec3 axis{};        ///< in the frame: of unit length for a revolute joint
  double length = 0;  ///< length of the axis
  /// Rotation of the frame in its parent at an angle: fixed + sin × odd + (1 − cos) × even; rows.
  std::array<Vec3, 3> fixed{}, odd{}, even{};
  Vec3 origin{};  ///< origin of the frame in its parent, at value 0
};

/// A node of the tree over a group's spheres: it contains the spheres of its children.
struct MotionNode {
  Sphere sphere{};                                           ///< in the frame's axes
  std::uint32_t body = 0, first_child = 0, child_count = 0;  ///< leaves have no child
};

/// A group of spheres that moves with a frame.
struct MotionBody {
  std::uint32_t frame = 0;
  std::uint32_t root = 0;    ///< node
  double spread = 0;         ///< largest distance of a node's center from the root's center
  std::uint32_t first = 0;   ///< place in MotionBodies::chains
  std::uint32_t joints = 0;  ///< number of frames that move it
};

/// Two bodies to test. The first `joints_a` joints of a's chain and `joints_b` of b's move them relative to each other.
struct MotionPair {
  std::uint32_t a = 0, b = 0, joints_a = 0, joints_b = 0;
};

struct MotionBodies {
  explicit MotionBodies(const ConfigurationQuery::Model& model);

  std::vector<MotionFrame> frames;  ///< each after its parent
  std::vector<MotionNode> nodes;
  std::vector<MotionBody> bodies;     ///< one per group of the model
  std::vector<std::uint32_t> chains;  ///< frames that move each body, from the body to the base
  std::vector<MotionPair> pairs;      ///< one per pair of the model
  double reach = 0;      ///< sum of all lengths from which a sphere's place is computed, without joints' values
  double deviation = 0;  ///< sum of all deviations of the fixed rotations from exact ones

 private:
  std::uint32_t add_tree(std::uint32_t body, std::vector<Sphere>& spheres);
  void fill(std::uint32_t node, std::span<Sphere> spheres);
};

}  // namespace morula::robot
