// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The joints between two links, and the relative poses of these links.
#pragma once

#include <morula/geometry/rigid_transform.hpp>
#include <morula/robot/robot.hpp>
#include <span>
#include <vector>

namespace morula::robot {

/// The range of a coordinate, and whether a search over it is meaningful.
struct CoordinateRange {
  double lower = 0, upper = 0;  ///< radians or mesh units
};

/// The ranges of all coordinates, and the joints whose own range is usable.
struct JointRanges {
  /// One per coordinate of robot.independent_joints. A joint that turns by a full circle or more, and that no other
  /// joint follows, has −π…π: the same poses. A coordinate without a usable range stays at its value at rest.
  std::vector<CoordinateRange> coordinates;
  /// One per joint: false for one that may stand anywhere (its range is unknown, it is floating or planar) or whose
  /// range is so long that samples of it say nothing: it slides by more than `long_travel` sizes of the robot, or turns
  /// farther than `far_turn`, or follows such a joint.
  std::vector<bool> usable;
};
inline constexpr double long_travel = 100, far_turn = 1000;
/// robot_size: mesh units.
JointRanges joint_ranges(const Robot& robot, double robot_size);

/// A joint of a chain that moves: its coordinate, and how it depends on it.
struct ChainJoint {
  std::size_t coordinate = 0;     ///< place in PairChain::coordinates
  double factor = 1, offset = 0;  ///< its value is factor × coordinate + offset
  bool slides = false;
  Vec3 axis{};
  RigidTransform before{};  ///< transform of the joint at 0, in the axes that the preceding joint moves
};

/// The joints from the last link that carries both to one of them.
struct Branch {
  std::vector<ChainJoint> joints;  ///< from the common link outward
  RigidTransform end{};            ///< transform of the link in the axes that its last joint moves
};

/// Both branches.
struct PairChain {
  Branch a, b;
  std::vector<std::size_t> coordinates;  ///< places in robot.independent_joints of the joints that move the links
                                         ///< relative to each other
  bool usable = true;                    ///< whether every joint of the chain has a usable range
};
PairChain chain_of(const Robot& robot, const JointRanges& ranges, std::size_t link_a, std::size_t link_b);

/// A joint of a chain in its present place.
struct PlacedJoint {
  Vec3 point, axis;  ///< a point of its axis, and its direction
  const ChainJoint* joint = nullptr;
};
/// Places the joints of a branch, in the axes of the common link; returns the pose of the branch's link.
/// values: one per coordinate of the chain.
RigidTransform place(const Branch& branch, std::span<const double> values, std::vector<PlacedJoint>& joints);

/// The sum of all lengths that a pose of one of the links is computed from, at any values in range: an upper bound of
/// how far the links' origins are from the common link's, mesh units.
double reach_of(const PairChain& chain, const JointRanges& ranges);

}  // namespace morula::robot
