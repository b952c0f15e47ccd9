// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "simd/float4.hpp"
#include "surface/boxes/tree_state.hpp"

namespace morula::detail {
namespace {

MinBox box_of(const BoxGroup& group) {
  MinBox box;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t place = 0; place < 8; ++place) {
      box.bound[k] = std::min(box.bound[k], group.bound[k][place]);
      box.bound[k + 4] = std::min(box.bound[k + 4], -group.bound[k + 3][place]);
    }
  return box;
}

}  // namespace

void SurfaceBoxes::make_levels(std::size_t blocks) {
  levels.clear();
  for (std::size_t boxes = blocks;; boxes = (boxes + 7) / 8) {
    levels.emplace_back((boxes + 7) / 8);
    for (BoxGroup& group : levels.back()) group.clear();
    if (boxes <= 8) break;
  }
}

void SurfaceBoxes::join_block(const SurfaceTreeState& s, std::size_t block) {
  // Two minima in turn, so that no instruction waits for the preceding one.
  Float4 lower[2] = {Float4(MinBox::none), Float4(MinBox::none)}, upper[2] = {lower[0], lower[0]};
  // mutant surface-corners: `i <` -> `i + corners_step <`
  for (std::uint32_t i = s.blocks.corners_begin[block]; i < s.blocks.corners_begin[block + 1]; i += corners_step)
    for (std::uint32_t k = 0; k < corners_step; ++k) {
      const MinBox& vertex = vertices[s.blocks.corners[i + k]];
      lower[k % 2] = min(Float4::load(vertex.bound), lower[k % 2]);
      upper[k % 2] = min(Float4::load(vertex.bound + 4), upper[k % 2]);
    }
  MinBox box;
  min(lower[0], lower[1]).store(box.bound);
  min(upper[0], upper[1]).store(box.bound + 4);
  put(levels[0][block / 8], block % 8, box);
}

void SurfaceBoxes::join_group(std::size_t level, std::size_t g) {
  const std::vector<BoxGroup>& below = levels[level - 1];
  for (std::size_t i = 8 * g; i < std::min(below.size(), 8 * g + 8); ++i)
    put(levels[level][g], i - 8 * g, box_of(below[i]));
}

void SurfaceBoxes::measure() {
  extent = 0;
  for (const float bound : box_of(levels.back()[0]).bound)
    if (std::isfinite(bound)) extent = std::max(extent, std::abs(static_cast<double>(bound)));
}

}  // namespace morula::detail
