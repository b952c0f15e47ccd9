// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rows of the table of neighbors: for one block, its pairs of features with all blocks from itself on that `rings`
// excludes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "surface/boxes/feature_boxes.hpp"

namespace morula::detail {

/// A row. A pair of blocks without an entry has no excluded pair.
struct RingRow {
  static constexpr std::uint32_t no_masks = 0xffffffffu;
  /// One block, or consecutive blocks whose pairs are all excluded.
  struct Entry {
    std::uint32_t first, last;
    std::uint32_t masks;  // begin of the masks; no_masks: all pairs are excluded
  };
  std::vector<Entry> entries;  // ascending
  std::vector<std::uint64_t> masks;

  std::size_t bytes() const {
    return sizeof *this + entries.capacity() * sizeof(Entry) + masks.capacity() * sizeof(std::uint64_t);
  }
};

/// For each vertex, the blocks that have a facet with it.
class BlocksOfVertices {
 public:
  explicit BlocksOfVertices(const SurfaceTreeState& s);
  /// Ascending, some of them more than once.
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(blocks_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
  }
  std::size_t bytes() const { return (begin_.size() + blocks_.size()) * sizeof(std::uint32_t); }

 private:
  std::vector<std::uint32_t> begin_, blocks_;
};

/// Makes one row after the other, for one thread. It keeps its memory, about 13 bytes per vertex.
class RingRowMaker {
 public:
  /// The most vertices in the rings about a block; with more there is no row, since it would take too long.
  static constexpr std::size_t most_vertices = 4096;

  RingRowMaker(const SurfaceTreeState& s, std::uint32_t rings, Features features, const BlocksOfVertices& blocks);
  /// None if the rings about the block hold too many vertices.
  std::optional<RingRow> make(std::uint32_t block);
  /// Memory of what is kept by vertex and by block.
  std::size_t bytes() const { return 3 * reached_from_.size() * sizeof(std::uint32_t) + is_partner_.size(); }

 private:
  /// The corners of features: for the row's block the bits of the block's vertices that they are, for another block the
  /// bits of those that are neighbors of one of them.
  struct FeatureBits {
    std::vector<std::uint32_t> facets, vertices, edges;
  };

  void forget();
  bool find_rings(std::uint32_t block);
  void advance();
  void find_partners(std::uint32_t block);
  template <class BitsOf>
  void take(std::uint32_t block, FeatureBits& features, const BitsOf& bits_of) const;
  void add_block(RingRow& row, std::uint32_t a, std::uint32_t b);
  void add_masks(RingRow& row, bool is_one_block) const;
  bool reaches_all_of(std::uint32_t block) const;

  const SurfaceTreeState& surface_;
  std::uint32_t rings_;
  Features features_;
  const BlocksOfVertices& blocks_of_vertices_;
  // By vertex, a bit for each vertex of the row's block: from which of them it was reached, since the last ring alone,
  // and in the next ring. All 0 for vertices that are not in reached_.
  std::vector<std::uint32_t> reached_from_, fresh_, next_;
  std::vector<std::uint32_t> reached_, front_, next_front_;
  std::uint32_t all_corners_ = 0;  // a bit for each vertex of the row's block
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> partners_;  // the blocks, from the row's own on, with a vertex that was reached, ascending
  std::vector<std::uint8_t> is_partner_;  // by block
  FeatureBits in_a_, in_b_;
};

}  // namespace morula::detail
