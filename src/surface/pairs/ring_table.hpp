// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ring table: the pairs of features of one surface that are neighbors, by blocks. A row is made when a search first
// needs it, so that making it is part of the search's budget.
//
// A row per block lists the blocks at or after it with which it has a pair of neighbors. An entry has 64 bits for every
// eight features against eight others, in the order in which PairSearch compares them, so that a search drops the
// neighbors of 64 pairs at once. Runs of blocks whose pairs are all neighbors share an entry without bits, so that a
// table has as many entries as there are blocks at the border of the rings.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <morula/parallel/threads.hpp>
#include <morula/parallel/workers.hpp>
#include <mutex>
#include <vector>

#include "surface/pairs/excluded_nodes.hpp"
#include "surface/pairs/ring_rows.hpp"

namespace morula::detail {

/// Any number of threads may use it at the same time.
class RingTable {
 public:
  /// rings: 1 or more. most_bytes: no row is added once the rows take as much. The surface has to live as long as rows
  /// are made.
  RingTable(const SurfaceTreeState& surface, std::uint32_t rings, Features features, std::size_t most_bytes);
  ~RingTable();
  RingTable(const RingTable&) = delete;
  RingTable& operator=(const RingTable&) = delete;

  /// Makes all rows, as far as the memory allows. The first call with all rows also makes the table of nodes.
  void make_all(Workers& workers);
  bool has_row(std::uint32_t block) const { return rows_[block].load(std::memory_order_acquire) != nullptr; }
  /// False once the rows take too much memory: some of them are missing then, and stay so.
  bool fits() const { return !is_too_large_.load(std::memory_order_relaxed); }
  std::size_t bytes() const;

  /// 64 bits for each eight features against eight others of two blocks, a <= b. With Features::facets facets against
  /// facets alone. Else groups of vertices of a against facets of b; if b is another block, facets of a against groups
  /// of vertices of b; then for each group of edges of a all groups of edges of b. Makes the row of a if there is none;
  /// null if it does not fit.
  const std::uint64_t* of(std::uint32_t a, std::uint32_t b);
  /// Whether all pairs of features of the blocks below two nodes of a height from 1 on are neighbors, a <= b. It is
  /// false before make_all() has made all rows.
  bool hold(std::size_t height, std::uint32_t a, std::uint32_t b) const {
    return has_nodes_.load(std::memory_order_acquire) && nodes_.hold(height, a, b);
  }

  /// The value of of() if no pair is excluded, and if all are.
  static const std::uint64_t* none() { return none_; }
  static const std::uint64_t* all() { return all_; }

 private:
  // Blocks have at most 24 vertices and 24 edges.
  static constexpr std::size_t most_masks = 3 + 3 + 3 * 3;
  static const std::uint64_t none_[most_masks], all_[most_masks];

  const RingRow* row(std::uint32_t block);
  std::unique_ptr<RingRowMaker> take_maker();
  void make_nodes();

  const SurfaceTreeState& surface_;
  std::uint32_t rings_;
  Features features_;
  std::size_t most_bytes_;
  BlocksOfVertices blocks_of_vertices_;
  std::vector<std::atomic<const RingRow*>> rows_;  // by block; null: not made yet
  std::atomic<std::size_t> row_bytes_ = 0, row_count_ = 0;
  std::atomic<bool> is_too_large_ = false, has_nodes_ = false;
  mutable Mutex mutex_;                              // of the members below
  std::vector<std::unique_ptr<RingRowMaker>> idle_;  // makers that no thread uses
  ExcludedNodes nodes_;                              // it does not change once has_nodes_ is true
};

}  // namespace morula::detail
