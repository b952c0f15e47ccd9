// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skin kernels: the loops of the rule `skinned`, for a group of nodes at once, one in each lane. One source,
// skin_kernels.inl, is compiled for each kind of processor, and the kind is chosen at run time.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// Nodes of a group. It is the same on all processors, on which the bits of the result must not depend.
inline constexpr std::size_t lanes_of_group = 16;
/// Moved balls that a hull keeps on the stack.
inline constexpr std::size_t most_kept_balls = 64;

using LaneFloats = float[lanes_of_group];
struct LaneVectors {
  LaneFloats x, y, z;
};
using LaneNumbers = double[lanes_of_group];
using Columns = std::array<Vec3f, 3>;

/// A bone's transform less the identity, in double: columns of the linear part, then the displacement of the pivot in
/// units, then zeros.
struct BoneRow {
  double entries[16]{};
};

/// Entries of a BoneRow, or of the difference of two, times SkinFrame::scale.
struct MotionRow {
  Columns linear;
  Vec3f shift;
  float size;  ///< at least the root of the sum of the squares of `linear`
  float unused[3];
};

/// A bone's transform in a frame, times SkinFrame::scale.
struct BoneMotion {
  MotionRow change;  ///< less the identity
  Columns linear;    ///< linear part
  float size;        ///< at least its largest stretch
};

struct BonePair {
  std::uint32_t main, other;
  auto operator<=>(const BonePair&) const = default;
};

/// A bone besides the main one, in all nodes of a group; all numbers are 0 in a node that it does not move.
struct GroupTerm {
  std::uint32_t bone = 0, pair = 0;
  LaneFloats weight{}, scale{}, weight_stray{}, moment_stray{};
  LaneVectors slope{}, moment{};
  LaneVectors ball{};        ///< about the pivot
  LaneFloats ball_radius{};  ///< below 0 in nodes that the bone does not move
};

/// Nodes with the same main bone. Lanes beyond `count` repeat the first node. Lengths are in units of the blend.
struct NodeGroup {
  std::uint32_t bone = 0;
  std::uint32_t first_term = 0, end_term = 0;
  std::uint32_t count = 0;
  std::uint32_t slot[lanes_of_group]{};                ///< numbers in SkinBlend::nodes
  LaneNumbers center_x{}, center_y{}, center_z{};      ///< at rest, mesh units
  LaneVectors place{};                                 ///< center at rest, about the pivot
  LaneFloats radius{};
  LaneFloats weight_strays{};                          ///< sums over the terms
  LaneFloats size_stray{}, turn_stray{};               ///< rounding, over a bone's size and that of its change
  LaneVectors shape_center{};
  LaneFloats shape_axes[6]{};                          ///< columns of the lower triangle
  LaneFloats shape_stray{};                            ///< rounding, over the stretch of a node
  LaneVectors ball{};                                  ///< ball of the main bone, about the pivot
  LaneFloats ball_radius{};                            ///< below 0 in nodes without balls
};

struct SkinFrame {
  const BoneMotion* bones;
  const MotionRow* pairs;
  const GroupTerm* terms;
  const Vec3* shifts;  ///< by bone: displacement of the pivot, mesh units; not scaled
  float scale = 1;   ///< a power of two: below 1 if transforms are too large for squares in float
  double unit = 1;   ///< length of a moved unit: unit of the blend over `scale`, mesh units
};

/// Spheres of a group: displacements of centers from place to moved place about the pivot, and radii, in moved units;
/// after `narrow` centers about the origin, and radii, in mesh units.
struct GroupSpheres {
  LaneVectors center;
  LaneFloats radius;
};

/// Contains all that the poser accepts: coordinates about the origin are below 2^57 at rest, and displacements, the
/// origin's included, below 2^56.
inline constexpr double largest_bound = 0x1p59;
/// Growth of a sphere, over that by its main bone, from which other bounds are tried for its group.
inline constexpr float loose = 1.1f;

/// All kernels give the same bits.
struct SkinKernels {
  /// Differences of rows, other bone less main bone, times `scale`.
  void (*differ)(const BoneRow* rows, std::span<const BonePair> pairs, double scale, MotionRow* differences);
  /// Bounds of the stretch of lanes_of_group matrices.
  void (*stretch)(const LaneVectors (&columns)[3], LaneFloats& stretches);
  /// Bounds of the nodes of a group (skinned.cpp).
  void (*bound)(const NodeGroup& group, const SkinFrame& frame, GroupSpheres& spheres);
  /// Replaces displacements by centers about the origin. Radii grow by the rounding and by the pad; a sphere beyond all
  /// accepted places is the largest one.
  void (*narrow)(const NodeGroup& group, const SkinFrame& frame, const Vec3& origin, double pad, GroupSpheres& spheres);
};

/// The kernels that this processor can run, narrowest first.
std::span<const SkinKernels> all_skin_kernels();
/// The widest kernels that this processor can run.
const SkinKernels& skin_kernels();

}  // namespace morula::detail
