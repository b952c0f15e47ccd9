// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Excluded pairs: which pairs of features of one surface are neighbors or near at rest, for many pairs at once: by a
// table of neighbors, and by boxes and shapes at rest.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/parallel/workers.hpp>
#include <optional>

#include "surface/pairs/exclusion_rule.hpp"
#include "surface/pairs/rest_boxes.hpp"
#include "surface/pairs/rest_shapes.hpp"
#include "surface/pairs/ring_table.hpp"

namespace morula::detail {

class ExcludedPairs {
 public:
  /// Largest size of a table of neighbors in bytes per facet. One row per thread may exceed it.
  static constexpr std::size_t most_bytes_per_facet = 512;

  /// Makes the boxes and shapes at rest if the surface has none yet. rule: a rule that excludes at least one pair.
  ExcludedPairs(const SurfaceTreeState& surface, const ExclusionRule& rule, Workers& workers);
  const ExclusionRule& rule() const { return rule_; }
  /// Makes what is missing of the table of neighbors.
  void make_table(Workers& workers) const {
    if (rings_) rings_->make_all(workers);
  }
  /// False if the table of neighbors is too large. Rows of it are missing then.
  bool is_whole() const { return !rings_ || rings_->fits(); }
  /// Whether neighbors() takes no longer than a look into a table.
  bool has_row(std::uint32_t block) const { return !rings_ || rings_->has_row(block); }
  /// The memory of this rule alone. Boxes and shapes at rest are the surface's: rest_bytes().
  std::size_t bytes() const { return sizeof *this + (rings_ ? rings_->bytes() : 0); }
  std::size_t rest_bytes() const {
    return (boxes_ ? boxes_->bytes() : 0) + (near_.is_able() ? near_.shapes().bytes() : 0);
  }

  /// The neighbors among the pairs of two blocks, as RingTable::of(); null if it does not know them.
  const std::uint64_t* neighbors(std::uint32_t a, std::uint32_t b) const {
    return rings_ ? rings_->of(a, b) : RingTable::none();
  }
  /// Proofs that pairs are near at rest; null if it has none.
  const NearAtRest* near_at_rest() const { return near_.is_able() ? &near_ : nullptr; }
  /// Whether all pairs of features of the blocks below two nodes of equal height are excluded, a not after b, as far as
  /// the boxes at rest show it and, with by_table, the rows that are there.
  bool are_all(const SurfaceTreeState& s, const BoxNode& a, const BoxNode& b, bool by_table) const;

 private:
  ExclusionRule rule_;
  std::unique_ptr<RingTable> rings_;        // null without rings
  std::shared_ptr<const RestBoxes> boxes_;  // null without a distance at rest
  NearAtRest near_;
};

/// The excluded pairs of a surface for a rule that excludes at least one. The surface keeps the last four. Any number
/// of threads may call this at the same time.
std::shared_ptr<const ExcludedPairs> excluded_pairs(const SurfaceTreeState& surface, const ExclusionRule& rule,
                                                    Workers& workers);

}  // namespace morula::detail
