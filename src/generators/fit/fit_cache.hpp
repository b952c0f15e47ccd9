// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Fit cache: which children are fitted already, and which are better whole.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "generators/fit/ball_fit.hpp"

namespace morula::detail {

/// What a fit depends on, besides siblings near by.
struct FitInputs {
  std::uint64_t points_hash;
  float overlap_weight;
  bool operator==(const FitInputs&) const = default;
};

/// Invariant: has_fit(b) is true only where ball b is what a fit to these inputs made, and no sibling has moved near
/// it, to or from, since. Every change of a ball goes through note_fit() or note_change(), which is all that
/// invalidates: entries are compared by time, never cleared one by one.
class FitCache {
 public:
  explicit FitCache(std::size_t most) : entries_(most) {}

  bool has_fit(std::size_t ball, const FitInputs& inputs, std::span<const GroupBall> balls) const;
  /// The ball was `before`, and is now the fit `after`.
  void note_fit(std::size_t ball, const GroupBall& before, const GroupBall& after, const FitInputs& inputs);
  /// The ball was `before`, and is now something else.
  void note_change(std::size_t ball, const GroupBall& before);

 private:
  struct Entry {
    std::uint64_t changed = 0, fitted = 0;  // times; 0: never
    FitInputs inputs{0, -1};
    GroupBall before{};  // the last change
  };
  std::vector<Entry> entries_;
  std::uint64_t clock_ = 0;
};

/// Balls that proved better whole than split, with their points and cost. Where siblings move, the cost changes: then
/// the same ball is a new entry, and nothing here ever needs to be invalidated.
class WholeBalls {
 public:
  static std::uint64_t key(const GroupBall& b, const FitInputs& inputs);
  bool contains(std::uint64_t key) const { return keys_.contains(key); }
  void insert(std::uint64_t key) { keys_.insert(key); }

 private:
  std::unordered_set<std::uint64_t> keys_;
};

}  // namespace morula::detail
