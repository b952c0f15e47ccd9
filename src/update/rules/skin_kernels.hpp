// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skin kernels: the loops of the rule `skinned`, for a group of nodes at once, one in each lane. One source,
// skin_kernels.inl, is compiled for each kind of processor, and the kind is chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// Nodes of a group. It is the same on all processors, on which the bits of the result must not depend.
inline constexpr std::size_t lanes_of_group = 8;
/// Moved balls that a hull keeps on the stack.
inline constexpr std::size_t most_kept_balls = 64;

using LaneNumbers = double[lanes_of_group];
struct LaneVectors {
  LaneNumbers x, y, z;
};

/// A bone's transform less the identity, or less that of another bone.
struct BoneMotion {
  std::array<Vec3, 3> columns;
  Vec3 shift;
  double size;  ///< at least the largest stretch: of the bone's linear part itself, or of the difference
};

/// A bone besides the main one, in all nodes of a group; all numbers are 0 in a node that it does not move.
struct GroupTerm {
  std::uint32_t bone = 0, pair = 0;
  LaneNumbers weight{}, scale{}, weight_stray{}, moment_stray{};
  LaneVectors slope{}, moment{};
  LaneVectors ball{};
  LaneNumbers ball_radius{};  ///< below 0 in nodes that the bone does not move
};

/// Nodes with the same main bone. Lanes beyond `count` repeat the first node.
struct NodeGroup {
  std::uint32_t bone = 0;
  std::uint32_t first_term = 0, end_term = 0;
  std::uint32_t count = 0;
  std::uint32_t slot[lanes_of_group]{};  ///< numbers in SkinBlend::nodes
  LaneVectors center{};                  ///< at rest
  LaneNumbers radius{};
  LaneNumbers weight_strays{};  ///< sums over the terms
  LaneVectors shape_center{}, shape_axes[3]{};
  LaneVectors ball{};         ///< ball of the main bone
  LaneNumbers ball_radius{};  ///< below 0 in nodes without balls
};

struct SkinFrame {
  const BoneMotion *bones, *pairs;
  const GroupTerm* terms;
};

/// Spheres of a group; centers are displacements of those at rest.
struct GroupSpheres {
  LaneVectors center;
  LaneNumbers radius;
};

/// Growth of a sphere, over that by its main bone, from which other bounds are tried for its group.
inline constexpr double loose = 1.1;

/// All kernels give the same bits.
struct SkinKernels {
  /// Bounds of the nodes of a group (skinned.cpp).
  void (*bound)(const NodeGroup& group, const SkinFrame& frame, GroupSpheres& spheres);
  /// Replaces displacements by centers about the origin, rounded to float. Radii grow by the rounding and by the pad.
  void (*narrow)(const NodeGroup& group, const Vec3& origin, double pad, GroupSpheres& spheres);
};

/// The kernels that this processor can run, narrowest first.
std::span<const SkinKernels> all_skin_kernels();
/// The widest kernels that this processor can run.
const SkinKernels& skin_kernels();

}  // namespace morula::detail
