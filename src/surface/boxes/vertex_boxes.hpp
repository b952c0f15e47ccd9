// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes of vertices: the kernel that rounds positions outwards to float.
#pragma once

#include <cstddef>
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
/// Narrowest first; what this processor runs. All give the same bits.
std::span<const MakeVertexBoxes> all_make_vertex_boxes();
/// The widest.
MakeVertexBoxes make_vertex_boxes();

}  // namespace morula::detail
