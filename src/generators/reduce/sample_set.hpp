// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sets of samples, as bits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/each_bit.hpp"

namespace morula::detail {

/// A subset of samples 0 … count − 1. The sets of one operation must have the same count.
class SampleSet {
 public:
  SampleSet() = default;
  explicit SampleSet(std::size_t count) : words_((count + 63) / 64) {}

  /// Sample i is bit i % 64 of word i / 64; all bits from the count on are 0.
  std::uint64_t* words() { return words_.data(); }

  void add(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  void remove(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
  bool has(std::size_t i) const { return ((words_[i / 64] >> (i % 64)) & 1u) != 0; }
  void clear() { words_.assign(words_.size(), 0); }

  std::size_t size() const {
    std::size_t n = 0;
    for (const std::uint64_t w : words_) n += bit_count(w);
    return n;
  }
  bool empty() const {
    for (const std::uint64_t w : words_)
      if (w != 0) return false;
    return true;
  }
  SampleSet& operator|=(const SampleSet& other) {
    for (std::size_t w = 0; w < words_.size(); ++w) words_[w] |= other.words_[w];
    return *this;
  }
  bool operator==(const SampleSet&) const = default;

  /// Members in ascending order.
  template <class Visitor>
  void for_each(const Visitor& visit) const {
    each_bit(words_, visit);
  }

 private:
  std::vector<std::uint64_t> words_;
};

}  // namespace morula::detail
