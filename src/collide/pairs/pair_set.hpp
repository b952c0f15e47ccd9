// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A set of pairs of indices that is filled, asked and emptied; its memory stays.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace morula::detail {

class PairSet {
 public:
  /// True when the key was not there. Not 2^64 - 1.
  bool insert(std::uint64_t key) {
    if (2 * size_ >= slots_.size()) grow();
    if (!put(key)) return false;
    ++size_;
    return true;
  }
  std::size_t size() const { return size_; }
  void clear() {
    std::fill(slots_.begin(), slots_.end(), nothing);
    size_ = 0;
  }

 private:
  static constexpr std::uint64_t nothing = ~std::uint64_t{0};

  bool put(std::uint64_t key) {
    const std::size_t mask = slots_.size() - 1;
    const int shift = 64 - std::countr_zero(slots_.size());
    for (std::size_t i = (key * 0x9e3779b97f4a7c15u) >> shift;; i = (i + 1) & mask) {
      if (slots_[i] == key) return false;
      if (slots_[i] != nothing) continue;
      slots_[i] = key;
      return true;
    }
  }
  void grow() {
    std::vector<std::uint64_t> before(std::max<std::size_t>(1024, 4 * slots_.size()), nothing);
    before.swap(slots_);
    for (const std::uint64_t key : before)
      if (key != nothing) put(key);
  }

  std::vector<std::uint64_t> slots_;  // a power of two of them
  std::size_t size_ = 0;
};

}  // namespace morula::detail
