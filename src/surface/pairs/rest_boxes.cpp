// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/rest_boxes.hpp"

#include <algorithm>

#include "surface/pairs/excluded_pairs.hpp"

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

void RestBoxes::find(const ExclusionTest& test, std::uint32_t block, std::size_t level, std::uint32_t i,
                     std::vector<BlockRange>& near, std::vector<std::uint32_t>& in_doubt) const {
  const std::size_t size = std::size_t{1} << (3 * level);
  const auto end = static_cast<std::uint32_t>(std::min((std::size_t{i} + 1) * size, levels_[0].size()));
  const Box &here = levels_[0][block], &there = levels_[level][i];
  if (end <= block || test.are_surely_apart(here, there)) return;
  if (test.are_surely_near(here, there)) {
    near.push_back({std::max(block, static_cast<std::uint32_t>(i * size)), end});
  } else if (level == 0) {
    in_doubt.push_back(i);
  } else {
    const auto children = std::min<std::size_t>(8 * std::size_t{i} + 8, levels_[level - 1].size());
    for (std::uint32_t child = 8 * i; child < children; ++child) find(test, block, level - 1, child, near, in_doubt);
  }
}

}  // namespace morula::detail
