// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Boxes of the nodes of a surface tree at rest, which prove of many pairs at once that they are near at rest.
#pragma once

#include <cstddef>
#include <morula/geometry/box.hpp>
#include <vector>

#include "surface/boxes/box_node.hpp"

namespace morula::detail {

/// Box i of level k contains boxes 8 i … 8 i + 7 of level k − 1, and level 0 holds the boxes of blocks.
class RestBoxes {
 public:
  explicit RestBoxes(const SurfaceTreeState& s);
  const Box& of(const BoxNode& node) const { return levels_[node.height][node.number]; }
  std::size_t bytes() const {
    std::size_t boxes = 0;
    for (const std::vector<Box>& level : levels_) boxes += level.size();
    return boxes * sizeof(Box);
  }

 private:
  std::vector<std::vector<Box>> levels_;
};

}  // namespace morula::detail
