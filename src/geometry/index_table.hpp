// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Indices found by the values that they represent: a hash table with open addresses.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "parallel/interruption.hpp"

namespace morula::detail {

/// The hash of three numbers, none of them NaN. 0 and −0 have the same hash.
inline std::uint64_t hash_of_numbers(double x, double y, double z) {
  std::uint64_t state = 0;
  for (const double number : {x, y, z}) {
    state = (state ^ std::bit_cast<std::uint64_t>(number + 0.0)) * 0x9e3779b97f4a7c15u;
    state ^= state >> 32;
  }
  state *= 0xbf58476d1ce4e5b9u;
  return state ^ state >> 32;
}

/// The table checks for interruption while it grows, and is freed as one block: std::unordered_map does neither, and
/// both take long for millions of entries.
class IndexTable {
 public:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// The index for which `matches` holds, among the indices of this hash; none if there is none.
  template <class Matches>
  std::uint32_t find(std::uint64_t hash, const Matches& matches) const {
    for (std::size_t place = first(hash); slots_[place] != none; place = next(place))
      if (matches(slots_[place])) return slots_[place];
    return none;
  }
  /// Adds an index that is not in the table. hash_of(i): the hash of an index that was added, or is being added.
  template <class HashOf>
  void add(std::uint32_t index, const HashOf& hash_of) {
    if (2 * ++count_ > slots_.size()) grow(hash_of);
    put(index, hash_of(index));
  }

 private:
  std::size_t first(std::uint64_t hash) const { return static_cast<std::size_t>(hash) & (slots_.size() - 1); }
  std::size_t next(std::size_t place) const { return (place + 1) & (slots_.size() - 1); }
  void put(std::uint32_t index, std::uint64_t hash) {
    std::size_t place = first(hash);
    while (slots_[place] != none) place = next(place);
    slots_[place] = index;
  }
  // It is out of line: inside add() it would prevent the inlining of add() and its callers.
  template <class HashOf>
  [[gnu::noinline]] void grow(const HashOf& hash_of) {
    std::vector<std::uint32_t> before(4 * slots_.size(), none);
    before.swap(slots_);
    InterruptPoller poll_interrupt(1u << 14);
    for (const std::uint32_t index : before) {
      if (index == none) continue;
      poll_interrupt();
      put(index, hash_of(index));
    }
  }

  std::vector<std::uint32_t> slots_ =
      std::vector<std::uint32_t>(1024, none);  // size is a power of two, at most half of it used
  std::size_t count_ = 0;
};

}  // namespace morula::detail
