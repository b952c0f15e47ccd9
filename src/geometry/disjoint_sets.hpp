// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Disjoint sets with path halving; the smallest index is the root, so the result does not depend on the order of joins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace morula::detail {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }
  /// Removes all indices and keeps the memory.
  void clear() { parents_.clear(); }
  /// Adds the next index, as a set of its own.
  std::uint32_t add() {
    parents_.push_back(static_cast<std::uint32_t>(parents_.size()));
    return parents_.back();
  }
  std::uint32_t root(std::uint32_t i) {
    while (parents_[i] != i) i = parents_[i] = parents_[parents_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a), b = root(b);
    if (a < b) parents_[b] = a;
    if (b < a) parents_[a] = b;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

}  // namespace morula::detail
