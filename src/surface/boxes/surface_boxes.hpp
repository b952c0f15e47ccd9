// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes of the vertices, blocks and groups of a surface tree in one pose or step.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "surface/boxes/box_groups.hpp"
#include "surface/boxes/vertex_boxes.hpp"

namespace morula::detail {

struct SurfaceTreeState;

/// A block without a box holds an empty one, which meets nothing.
struct SurfaceBoxes {
  std::vector<MinBox> vertices;               // by slot
  std::vector<std::vector<BoxGroup>> levels;  // the lowest first
  double extent = 0;                          // no box reaches farther from the origin along an axis

  /// Levels for so many blocks, all of them empty.
  void make_levels(std::size_t blocks);
  /// The box of a block, from those of its vertices.
  void join_block(const SurfaceTreeState& s, std::size_t block);
  /// Group g of a level above the lowest, from the groups below.
  void join_group(std::size_t level, std::size_t g);
  /// Sets `extent` by the highest level.
  void measure();
};

inline void put(BoxGroup& group, std::size_t place, const MinBox& box) {
  for (std::size_t k = 0; k < 3; ++k) {
    group.bound[k][place] = box.bound[k];
    group.bound[k + 3][place] = -box.bound[k + 4];
  }
}

/// The corners of a block are a multiple of so many, the last one repeated: nearly all blocks have as many, which
/// processors foresee.
inline constexpr std::uint32_t corners_step = 4;

/// What workers take at once, and vertices that are read before their boxes are made.
inline constexpr std::size_t vertices_at_once = 8192, groups_at_once = 256, vertices_together = 128;

/// Boxes are made only of vertices that are near the origin of their surface.
inline constexpr double farthest_vertex = 0x1p102;
inline bool is_near(const Vec3& p) {
  // Without branches.
  const auto is_far = [](double x) { return static_cast<unsigned>(!(std::abs(x) <= farthest_vertex)); };
  return is_far(p.x) + is_far(p.y) + is_far(p.z) == 0;
}

}  // namespace morula::detail
