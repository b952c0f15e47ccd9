// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Excluded nodes: pairs of nodes of a surface tree of which every pair of blocks is excluded, by runs in rows.
//
// Claim: hold(h, a, b) is true only if all pairs of a block below node a and a block at or after it below node b are in
// a run of their row. Searches compare no other pairs of blocks.
//
// Proof, by the height. Let it be true of height h, where row a has runs of nodes from a on. Node B of height h + 1 is
// put into the run of row A only if each child row a of A has a run that holds all children of B that are not before a:
// those from max(a, 8 B) on. A run [first, last] with first > a holds them only for B with 8 B >= first, which is after
// A; a run that begins at a also for B = A. It holds the last child of B if last is that child, the last of eight, or
// the last node of all. The pairs of a child of A and a child of B, the one not after the other, are these pairs.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace morula::detail {

class ExcludedNodes {
 public:
  /// Nodes [first, last].
  struct Run {
    std::uint32_t first, last;
  };

  ExcludedNodes() = default;
  /// Row b of height 0 has the runs [begin[b], begin[b + 1]): ascending, apart, from b on. Heights whose runs would
  /// exceed most_bytes, and those above them, hold no pair.
  ExcludedNodes(std::vector<std::uint32_t> begin, std::vector<Run> runs, std::size_t most_bytes);
  /// Whether every pair of blocks below two nodes of a height from 1 on is excluded, a <= b.
  bool hold(std::size_t height, std::uint32_t a, std::uint32_t b) const;
  std::size_t bytes() const;

 private:
  struct Rows {
    std::vector<std::uint32_t> begin;
    std::vector<Run> runs;
    std::size_t bytes() const { return begin.size() * sizeof(begin[0]) + runs.size() * sizeof(Run); }
  };
  static Rows rows_above(const Rows& below);

  std::vector<Rows> heights_;  // from height 1 on
};

}  // namespace morula::detail
