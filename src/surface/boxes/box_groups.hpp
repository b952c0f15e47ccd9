// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes in floats, and two kernels: one makes the boxes of vertices, one tests eight boxes against eight.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// Lower x, y, z, nothing, and the upper ones negated, so that one box holds others by eight minima.
struct alignas(32) MinBox {
  static constexpr float none = std::numeric_limits<float>::infinity();
  float bound[8] = {none, none, none, none, none, none, none, none};

  void add(const MinBox& b) {
    for (int k = 0; k < 8; ++k) bound[k] = b.bound[k] < bound[k] ? b.bound[k] : bound[k];
  }
};

/// The box of each vertex: from lower[i] to upper[i], each number rounded to the largest float that is not above it, or
/// the least that is not below it; sizes below 2^103. One more double may be read behind each array.
using MakeVertexBoxes = void (*)(const Vec3* lower, const Vec3* upper, std::size_t count, MinBox* boxes);
/// The kernels that this processor runs, the narrowest first. All give the same bits.
std::span<const MakeVertexBoxes> all_make_vertex_boxes();
/// The widest kernel.
MakeVertexBoxes make_vertex_boxes();

/// Eight boxes side by side. Bounds in columns: lower x, y, z, then upper. Closed. Unused places hold an empty box,
/// which meets nothing.
struct alignas(64) BoxGroup {
  static constexpr float none = std::numeric_limits<float>::infinity();
  float bound[6][8];

  void clear() {
    for (int k = 0; k < 8; ++k)
      for (int axis = 0; axis < 3; ++axis) bound[axis][k] = none, bound[axis + 3][k] = -none;
  }
};

/// How far b's boxes reach beyond themselves: `up` is added to their upper bounds, `down` to their lower ones.
struct BoxReach {
  float up[3] = {0, 0, 0};
  float down[3] = {0, 0, 0};
};

/// Bit 8 i + j: box i of a meets box j of b. All kinds of processors compute the same bits: a sum of two floats,
/// rounded to nearest, is compared.
using MeetGroups = std::uint64_t (*)(const BoxGroup& a, const BoxGroup& b, const BoxReach& reach);
/// The kernels that this processor runs, the narrowest first.
std::span<const MeetGroups> all_meet_groups();
/// The widest kernel.
MeetGroups meet_groups();

}  // namespace morula::detail
