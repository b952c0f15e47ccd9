// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nodes of a surface tree, on which searches descend.
//
//   height 2      groups of eight nodes of height 1     their boxes: levels[1]
//   height 1      groups of eight blocks                their boxes: levels[0]
//   height 0      blocks of eight facets, with the edges and vertices that they own
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

/// Below node n of height h are nodes 8 n … 8 n + 7 of height h - 1, up to the number of nodes of that height.
struct BoxNode {
  std::uint32_t number = 0;
  std::uint16_t height = 0;

  static BoxNode root(const SurfaceTreeState& s) { return {0, static_cast<std::uint16_t>(s.boxes.levels.size())}; }
  bool operator==(const BoxNode&) const = default;
  bool is_block() const { return height == 0; }
  BoxNode child(std::uint32_t i) const { return {8 * number + i, static_cast<std::uint16_t>(height - 1)}; }
  std::uint32_t child_count(const SurfaceTreeState& s) const {
    const std::size_t all = height == 1 ? s.block_count() : s.boxes.levels[height - std::size_t{2}].size();
    return static_cast<std::uint32_t>(std::min<std::size_t>(8, all - 8 * std::size_t{number}));
  }
  /// The boxes of its children. The node is no block.
  const BoxGroup& boxes(const SurfaceBoxes& of) const { return of.levels[height - std::size_t{1}][number]; }
};

/// The facets below a node.
inline std::span<const std::uint32_t> facets_below(const SurfaceTreeState& s, std::uint32_t number, int height) {
  const std::size_t size = std::size_t{1} << (3 * (height + 1));
  const std::size_t begin = std::min(s.blocks.order.size(), number * size),
                    end = std::min(s.blocks.order.size(), begin + size);
  return std::span<const std::uint32_t>(s.blocks.order).subspan(begin, end - begin);
}

}  // namespace morula::detail
