// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Descent to all final pairs that overlap. Without a budget it is depth-first, without a queue or a front.
#pragma once

#include <limits>

#include "collide/pairs/tree_pair.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {

struct Descent {
  std::size_t tests = 0;  ///< number of tests of node pairs
  bool finished = true;   ///< false if the limit of tests ended the descent before f was called for all pairs
};

/// Calls f(node of a, node of b) for every final pair that overlaps, as do all pairs above it: depth-first, by the
/// nodes of b, then of a. Stops before it would exceed most_tests.
template <class Final>
Descent each_overlapping(const TreePair& trees, const Final& f,
                         std::size_t most_tests = std::numeric_limits<std::size_t>::max()) {
  if (most_tests == 0) return {.finished = false};
  Descent result{.tests = 1};
  InterruptPoller poll_interrupt(128);
  const auto enter = [&](const auto& self, std::uint32_t a, std::uint32_t b, std::uint32_t depth) -> void {
    if (trees.is_final(a, b, depth)) return f(a, b);
    const NodeRange below_a = trees.below_a(a, depth), below_b = trees.below_b(b, depth);
    const std::size_t tests = std::size_t{below_a.count} * below_b.count;
    // mutant descent-stays-within-budget: `tests > most_tests - result.tests` -> `false`
    if (tests > most_tests - result.tests) {
      // mutant descent-tells-what-is-open: `false` -> `true`
      result.finished = false;
      return;
    }
    poll_interrupt();
    std::uint64_t masks[max_branching];
    trees.test(below_a, below_b, masks);
    result.tests += tests;
    any_overlapping(below_a, below_b, masks, [&](std::uint32_t child_a, std::uint32_t child_b) {
      self(self, child_a, child_b, depth + 1);
      return !result.finished;
    });
  };
  if (trees.overlaps(0, 0)) enter(enter, 0, 0, 0);
  return result;
}

}  // namespace morula::detail
