// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rows of bits, chosen one after the other: each time the row with most bits that no chosen row has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/each_bit.hpp"

namespace morula::detail {

class GreedyRows {
 public:
  /// bits: borrowed; row after row of `words` words.
  GreedyRows(std::span<const std::uint64_t> bits, std::size_t words)
      : bits_(bits),
        words_(words),
        open_(words, ~std::uint64_t{0}),
        most_new_(words > 0 ? bits.size() / words : 0, 64 * words) {}

  struct Choice {
    std::uint32_t row;
    std::size_t new_bits;  ///< 0: no row has a new bit
  };
  /// Returns the first among equals. Cost: one pass over the rows that may have more new bits than the best row so far.
  Choice choose() {
    Choice best{0, 0};
    for (std::uint32_t row = 0; row < most_new_.size(); ++row) {
      // The number of new bits of a row only falls.
      if (most_new_[row] <= best.new_bits) continue;
      std::size_t count = 0;
      for (std::size_t w = 0; w < words_; ++w) count += bit_count(word(row, w) & open_[w]);
      most_new_[row] = count;
      if (count > best.new_bits) best = {row, count};
    }
    if (best.new_bits > 0)
      for (std::size_t w = 0; w < words_; ++w) open_[w] &= ~word(best.row, w);
    return best;
  }

 private:
  std::uint64_t word(std::uint32_t row, std::size_t w) const { return bits_[row * words_ + w]; }

  std::span<const std::uint64_t> bits_;
  std::size_t words_;
  std::vector<std::uint64_t> open_;    // bits that no chosen row has
  std::vector<std::size_t> most_new_;  // new bits of each row when it was last counted
};

}  // namespace morula::detail
