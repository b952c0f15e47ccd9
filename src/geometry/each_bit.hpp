// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sets of small numbers as bits of words.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace morula::detail {

/// std::popcount without a processor's instruction is a function call with a table; this is a dozen operations in line.
inline std::size_t bit_count(std::uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return bits * 0x0101010101010101u >> 56;
}

/// Calls visit(i) for every bit that is set, ascending: bit i % 64 of word i / 64.
template <class Visit>
void each_bit(std::span<const std::uint64_t> words, const Visit& visit) {
  for (std::size_t w = 0; w < words.size(); ++w)
    for (std::uint64_t left = words[w]; left != 0; left &= left - 1)
      visit(64 * w + static_cast<std::size_t>(std::countr_zero(left)));
}

}  // namespace morula::detail
