// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/rest_boxes.hpp"

#include <algorithm>

namespace morula::detail {

RestBoxes::RestBoxes(const SurfaceTreeState& s) {
  std::vector<Box>& blocks = levels_.emplace_back(s.block_count());
  for (std::size_t i = 0; i < s.blocks.order.size(); ++i)
    for (const std::uint32_t v : s.blocks.facets_in_order[i]) blocks[i / 8].add(s.mesh.rest[v]);
  while (levels_.back().size() > 1) {
    std::vector<Box> next((levels_.back().size() + 7) / 8);
    for (std::size_t i = 0; i < levels_.back().size(); ++i) next[i / 8].add(levels_.back()[i]);
    levels_.push_back(std::move(next));
  }
}

}  // namespace morula::detail
