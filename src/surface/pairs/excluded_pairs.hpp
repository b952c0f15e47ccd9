// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Excluded pairs: which pairs of features of one surface are neighbors or near at rest, as a table made once.
//
// A row per block lists the blocks at or after it with which it has an excluded pair. An entry has 64 bits for every
// eight features against eight others, in the order in which PairSearch compares them, so that a search drops the
// excluded ones of 64 pairs at once. Runs of blocks whose pairs are all excluded share an entry without bits, so that a
// table has as many entries as there are blocks at the border of the excluded set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/parallel/workers.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <vector>

#include "surface/boxes/feature_boxes.hpp"
#include "surface/pairs/excluded_nodes.hpp"
#include "surface/pairs/near_points.hpp"
#include "surface/pairs/rest_boxes.hpp"

namespace morula::detail {

/// The exclusions by PairFilter::rings and rest_distance.
struct ExclusionRule {
  std::uint32_t rings = 0;
  double rest_distance = 0;
  Features features = Features::all;
  bool excludes_any() const { return rings > 0 || rest_distance > 0; }
  bool operator==(const ExclusionRule&) const = default;
};

/// Whether a rule excludes a pair, decided for that pair alone. It is slow: it serves to make tables, and searches
/// without a table.
class ExclusionTest {
 public:
  ExclusionTest(const SurfaceTreeState& surface, const ExclusionRule& rule);
  bool excludes(const FeaturePair& pair) const { return are_near_at_rest(pair) || are_neighbors(pair); }
  bool are_near_at_rest(const FeaturePair& pair) const;
  /// Whether a vertex of the one is at most so many edges from a vertex of the other.
  bool are_neighbors(const FeaturePair& pair) const;
  /// The allowance for rounding of distances at rest, mesh units.
  double rounding() const { return rounding_; }
  /// Whether all features in these boxes are farther apart at rest; whether all are as near.
  bool are_surely_apart(const Box& a, const Box& b) const;
  bool are_surely_near(const Box& a, const Box& b) const;

 private:
  const SurfaceTreeState& surface_;
  ExclusionRule rule_;
  double rounding_;
};

class ExcludedPairs {
 public:
  /// The largest memory of a table that is kept, bytes per facet.
  static constexpr std::size_t most_bytes_per_facet = 512;
  /// The most vertices in the rings about a vertex; with more, no table is made, since that would take too long.
  static constexpr std::size_t most_vertices_in_rings = 4096;

  /// The pairs of the table: of the whole rule, or of its rings alone. The search then excludes pairs that are near at
  /// rest by their boxes and points, and FeatureFilter tests the others one by one: a table of them takes longer than
  /// many queries.
  enum class Table : std::uint8_t { whole, rings };
  ExcludedPairs(const SurfaceTreeState& surface, const ExclusionRule& rule, Workers& workers,
                Table table = Table::whole);
  const ExclusionRule& rule() const { return rule_; }
  /// False when the table would be too large, or has no rule; it then has no rows.
  bool is_kept() const { return is_kept_; }
  /// Points that prove that pairs outside of the table are near at rest; null without any.
  const RestPoints* points() const { return points_.are_made() ? &points_ : nullptr; }
  std::size_t bytes() const;

  /// 64 bits for each eight features against eight others of two blocks, a <= b. With Features::facets facets against
  /// facets alone. Else groups of vertices of a against facets of b; if b is another block, facets of a against groups
  /// of vertices of b; then for each group of edges of a all groups of edges of b. Without a table, none().
  const std::uint64_t* of(std::uint32_t a, std::uint32_t b) const;
  /// The value that of() returns when no pair is excluded.
  static const std::uint64_t* none() { return none_; }
  /// Whether all pairs of features of the blocks below two nodes of equal height are excluded, a not after b, as far as
  /// the table or the boxes at rest show it. s: the surface of the table.
  bool are_all(const SurfaceTreeState& s, const BoxNode& a, const BoxNode& b) const;
  /// Whether a value of of() excludes all pairs.
  static bool are_all(const std::uint64_t* masks) { return masks == all_; }

 private:
  // Blocks have at most 24 vertices and 24 edges.
  static constexpr std::size_t most_masks = 3 + 3 + 3 * 3;
  static const std::uint64_t none_[most_masks], all_[most_masks];
  static constexpr std::uint32_t no_masks = 0xffffffffu;
  /// The entry of one block, or of consecutive blocks whose pairs are all excluded.
  struct Entry {
    std::uint32_t first, last;
    std::uint32_t masks;  // begin of the masks; no_masks: all pairs are excluded
  };
  friend class ExclusionRows;

  void make_rows(const SurfaceTreeState& s, const ExclusionRule& rule, Workers& workers);
  void make_nodes(std::size_t most_bytes);

  ExclusionRule rule_;
  RestBoxes boxes_;
  bool is_kept_ = false;
  std::vector<std::uint32_t> begin_;  // row of block b: entries_[begin_[b] … begin_[b + 1]), ascending
  std::vector<Entry> entries_;
  std::vector<std::uint64_t> masks_;
  ExcludedNodes nodes_;
  RestPoints points_;
};

/// The table of a surface for a rule that excludes at least one pair. The surface keeps the last four. Any number of
/// threads may call this at the same time.
std::shared_ptr<const ExcludedPairs> excluded_pairs(const SurfaceTreeState& surface, const ExclusionRule& rule,
                                                    Workers& workers);

}  // namespace morula::detail
