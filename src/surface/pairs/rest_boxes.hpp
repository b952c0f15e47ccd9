// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes of the nodes of a surface tree at rest, which decide of many pairs at once whether they are near at rest.
#pragma once

#include <cstdint>
#include <morula/geometry/box.hpp>
#include <vector>

#include "surface/boxes/box_node.hpp"

namespace morula::detail {

class ExclusionTest;

/// Blocks [begin, end).
struct BlockRange {
  std::uint32_t begin, end;
};

/// Box i of level k contains boxes 8 i … 8 i + 7 of level k − 1, and level 0 holds the boxes of blocks.
class RestBoxes {
 public:
  explicit RestBoxes(const SurfaceTreeState& s);
  const Box& of(const BoxNode& node) const { return levels_[node.height][node.number]; }
  /// Adds, ascending, the blocks from `block` on that are surely near it, and the blocks that are neither surely near
  /// nor surely apart.
  void find(const ExclusionTest& test, std::uint32_t block, std::vector<BlockRange>& near,
            std::vector<std::uint32_t>& in_doubt) const {
    find(test, block, levels_.size() - 1, 0, near, in_doubt);
  }

 private:
  void find(const ExclusionTest& test, std::uint32_t block, std::size_t level, std::uint32_t i,
            std::vector<BlockRange>& near, std::vector<std::uint32_t>& in_doubt) const;

  std::vector<std::vector<Box>> levels_;
};

}  // namespace morula::detail
