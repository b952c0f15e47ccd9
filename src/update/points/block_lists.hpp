// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lists of the items that depend on a block of vertices: an update of a part of the vertices starts from them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace morula::detail {

/// Vertices that partial updates treat as one: consecutive ones of the ownership's order.
inline constexpr std::size_t vertices_per_block = 32;

class BlockLists {
 public:
  BlockLists() = default;
  /// pairs (block, item), in any order and with repetitions.
  BlockLists(std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs, std::size_t block_count) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    begin_.assign(block_count + 1, 0);
    for (const auto& [block, item] : pairs) {
      ++begin_[block + 1];
      items_.push_back(item);
    }
    for (std::size_t b = 0; b < block_count; ++b) begin_[b + 1] += begin_[b];
  }
  std::span<const std::uint32_t> of(std::uint32_t block) const {
    return std::span(items_).subspan(begin_[block], begin_[block + 1] - begin_[block]);
  }

 private:
  std::vector<std::uint32_t> begin_, items_;
};

}  // namespace morula::detail
