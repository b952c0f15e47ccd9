// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A set of small numbers that is filled, walked upwards and emptied over and over.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/each_bit.hpp"

namespace morula::detail {

/// A set of numbers below `count`. It has a bit for each, so to empty it or to walk it costs a step for every 64.
class Marks {
 public:
  explicit Marks(std::size_t count = 0) : words_((count + 63) / 64) {}
  void add(std::uint32_t i) noexcept { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  void remove(std::uint32_t i) noexcept { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
  bool has(std::uint32_t i) const noexcept { return (words_[i / 64] >> (i % 64) & 1) != 0; }
  void clear() noexcept { std::fill(words_.begin(), words_.end(), std::uint64_t{0}); }
  /// Calls visit(i) for each, ascending. The visitor must not add numbers.
  template <class Visit>
  void each(const Visit& visit) const {
    each_bit(words_, [&](std::size_t i) { visit(static_cast<std::uint32_t>(i)); });
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace morula::detail
