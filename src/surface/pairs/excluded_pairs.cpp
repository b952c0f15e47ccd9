// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/excluded_pairs.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>

#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"
#include "surface/pairs/feature_filter.hpp"

namespace morula::detail {
namespace {

constexpr std::uint64_t all_bits = ~std::uint64_t{0};

/// A breadth-first search along edges. It keeps its memory.
class RingSearch {
 public:
  /// Calls reached(v) for every vertex that is at most so many edges from one of `from`, each once and the nearest
  /// first, until it returns true. Returns whether it did.
  template <class Reached>
  bool run(const SurfaceTreeState& s, std::span<const std::uint32_t> from, std::uint32_t rings,
           const Reached& reached) {
    if (stamp_.size() < s.mesh.rest.size()) stamp_.resize(s.mesh.rest.size(), now_);
    if (++now_ == 0) {
      std::fill(stamp_.begin(), stamp_.end(), 0u);
      now_ = 1;
    }
    queue_.clear();
    for (const std::uint32_t v : from)
      if (take(v) && reached(v)) return true;
    std::size_t begin = 0;
    for (std::uint32_t ring = 0; ring < rings && begin < queue_.size(); ++ring)
      for (const std::size_t end = queue_.size(); begin < end; ++begin)
        for (std::uint32_t i = s.mesh.ring_begin[queue_[begin]]; i < s.mesh.ring_begin[queue_[begin] + 1]; ++i)
          if (take(s.mesh.ring[i]) && reached(s.mesh.ring[i])) return true;
    return false;
  }
  std::size_t reached_count() const { return queue_.size(); }

 private:
  bool take(std::uint32_t v) {
    if (stamp_[v] == now_) return false;
    stamp_[v] = now_;
    queue_.push_back(v);
    return true;
  }

  std::vector<std::uint32_t> stamp_, queue_;
  std::uint32_t now_ = 0;
};

/// The vertices in the rings of any vertex of one block. find() fills it for each row.
class BlockRings {
 public:
  explicit BlockRings(const SurfaceTreeState& s) { reached_from_.assign(s.mesh.rest.size(), 0); }
  /// Searches from each of these vertices, at most 32. Returns false if the rings hold too many vertices.
  bool find(const SurfaceTreeState& s, std::span<const std::uint32_t> corners, std::uint32_t rings) {
    for (const std::uint32_t v : reached_) reached_from_[v] = 0;
    reached_.clear();
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const bool is_too_much = search_.run(s, corners.subspan(k, 1), rings, [&](std::uint32_t v) {
        if (reached_from_[v] == 0) reached_.push_back(v);
        reached_from_[v] |= 1u << k;
        return search_.reached_count() > ExcludedPairs::most_vertices_in_rings;
      });
      if (is_too_much) return false;
    }
    return true;
  }
  std::span<const std::uint32_t> reached() const { return reached_; }
  /// The vertices from which a vertex was reached, a bit each.
  std::uint32_t reached_from(std::uint32_t vertex) const { return reached_from_[vertex]; }

 private:
  RingSearch search_;
  std::vector<std::uint32_t> reached_;
  std::vector<std::uint32_t> reached_from_;  // by vertex, a bit per start; 0 for all vertices that are not in reached_
};

/// A feature of a block.
struct Place {
  std::uint32_t number;
  Box box;                // box at rest
  std::uint32_t corners;  // the feature's corners, a bit per vertex of the block
  std::uint32_t joined;   // vertices of the row's block that are neighbors of one of its vertices, a bit each
};

/// The features of a block, at the places where FeatureBoxes has them.
struct BlockPlaces {
  std::vector<std::uint32_t> corners;  // the block's vertices, each once
  std::vector<Place> facets, vertices, edges;

  void take(const SurfaceTreeState& s, std::uint32_t block, Features features) {
    corners.clear(), facets.clear(), vertices.clear(), edges.clear();
    const std::size_t begin = 8 * std::size_t{block}, end = std::min(s.blocks.order.size(), begin + 8);
    for (std::size_t i = begin; i < end; ++i) add(s, facets, s.blocks.order[i], s.blocks.facets_in_order[i]);
    if (features == Features::facets) return;
    for (std::uint32_t i = s.blocks.own_vertices[block]; i < s.blocks.own_vertices[block + 1]; ++i)
      add(s, vertices, s.blocks.vertex_of_slot[i], std::array{s.blocks.vertex_of_slot[i]});
    for (std::uint32_t i = s.blocks.own_edges_begin[block]; i < s.blocks.own_edges_begin[block + 1]; ++i)
      add(s, edges, s.blocks.own_edges[i], s.blocks.ends_of_own_edges[i]);
  }
  /// joined_to(v) returns the vertices of the row's block that are neighbors of v.
  template <class JoinedTo>
  void join(const JoinedTo& joined_to) {
    std::array<std::uint32_t, 24> of_corner{};
    for (std::size_t k = 0; k < corners.size(); ++k) of_corner[k] = joined_to(corners[k]);
    for (std::vector<Place>* places : {&facets, &vertices, &edges})
      for (Place& place : *places)
        for (std::size_t k = 0; k < corners.size(); ++k)
          if ((place.corners >> k & 1) != 0) place.joined |= of_corner[k];
  }

 private:
  template <std::size_t N>
  void add(const SurfaceTreeState& s, std::vector<Place>& places, std::uint32_t number,
           const std::array<std::uint32_t, N>& vertices_of_it) {
    Place& place = places.emplace_back(Place{number, {}, 0, 0});
    for (const std::uint32_t v : vertices_of_it) {
      place.box.add(s.mesh.rest[v]);
      const auto at = std::find(corners.begin(), corners.end(), v);
      place.corners |= 1u << (at - corners.begin());
      if (at == corners.end()) corners.push_back(v);
    }
  }
};

/// For each vertex, the blocks that have a facet with it.
class BlocksOfVertices {
 public:
  explicit BlocksOfVertices(const SurfaceTreeState& s) : begin_(s.mesh.rest.size() + 1) {
    for (const Facet& facet : s.blocks.facets_in_order)
      for (const std::uint32_t v : facet) ++begin_[v + 1];
    for (std::size_t v = 0; v < s.mesh.rest.size(); ++v) begin_[v + 1] += begin_[v];
    blocks_.resize(begin_.back());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < s.blocks.facets_in_order.size(); ++i)
      for (const std::uint32_t v : s.blocks.facets_in_order[i]) blocks_[next[v]++] = static_cast<std::uint32_t>(i / 8);
  }
  /// The blocks of a vertex, ascending, some of them more than once.
  std::span<const std::uint32_t> of(std::uint32_t vertex) const {
    return std::span(blocks_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
  }

 private:
  std::vector<std::uint32_t> begin_, blocks_;
};

}  // namespace

ExclusionTest::ExclusionTest(const SurfaceTreeState& surface, const ExclusionRule& rule)
    // mutant exclusion-rounding: `0x1p-40` -> `0`
    : surface_(surface), rule_(rule), rounding_(0x1p-40 * (surface.rest_reach + rule.rest_distance)) {}

bool ExclusionTest::are_neighbors(const FeaturePair& pair) const {
  if (rule_.rings == 0) return false;
  const FeatureVertices a(surface_, feature_a(pair.kind), pair.a), b(surface_, feature_b(pair.kind), pair.b);
  thread_local RingSearch search;
  return search.run(surface_, std::span(a.begin(), a.end()), rule_.rings,
                    [&](std::uint32_t v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

bool ExclusionTest::are_near_at_rest(const FeaturePair& pair) const {
  return rule_.rest_distance > 0 && are_within_at_rest(surface_, pair, rule_.rest_distance);
}

// are_within_at_rest() compares the rounded distance of two points of the features, which is off by less than 2^-46 of
// the largest coordinate: up to the allowance here, it is no less than the gap between the boxes and no more than the
// extent of both together. Differences of coordinates, and lengths of them, are off by 2^-50 of themselves, which is
// less yet.
bool ExclusionTest::are_surely_apart(const Box& a, const Box& b) const {
  if (!(rule_.rest_distance > 0)) return true;
  const Vec3 gap = max(max(a.lower - b.upper, b.lower - a.upper), Vec3{});
  return length(gap) > rule_.rest_distance + rounding_;
}

bool ExclusionTest::are_surely_near(const Box& a, const Box& b) const {
  if (!(rule_.rest_distance > 0)) return false;
  const Vec3 across = max(a.upper - b.lower, b.upper - a.lower);
  // mutant exclusion-sure: `length` -> `0.5 * length`
  return length(across) <= rule_.rest_distance - rounding_;
}

const std::uint64_t ExcludedPairs::none_[most_masks] = {};
const std::uint64_t ExcludedPairs::all_[most_masks] = {all_bits, all_bits, all_bits, all_bits, all_bits,
                                                       all_bits, all_bits, all_bits, all_bits, all_bits,
                                                       all_bits, all_bits, all_bits, all_bits, all_bits};

/// The input of all rows of a table, the same for all threads. ExcludedPairs() makes it once.
struct ExclusionSource {
  ExclusionSource(const SurfaceTreeState& s, const ExclusionRule& of, const RestBoxes& of_blocks)
      : surface(s), rule(of), test(s, of), boxes(of_blocks), blocks_of_vertices(s) {}

  const SurfaceTreeState& surface;
  const ExclusionRule& rule;
  const ExclusionTest test;
  const RestBoxes& boxes;
  const BlocksOfVertices blocks_of_vertices;
};

/// Rows of the table, one after the other, for a part of the blocks, with memory of its own.
class ExclusionRows {
 public:
  explicit ExclusionRows(const ExclusionSource& source) : source_(source), rings_(source.surface) {}

  /// Returns false if the rings of the rule hold too many vertices.
  bool add(std::uint32_t block) {
    places_a_.take(source_.surface, block, source_.rule.features);
    if (!rings_.find(source_.surface, places_a_.corners, source_.rule.rings)) return false;
    find_partners(block);
    row_ = entries.size();
    auto next = partners_.in_doubt.begin();
    const auto end = partners_.in_doubt.end();
    for (const BlockRange& range : partners_.excluded) {
      for (; next != end && *next < range.begin; ++next) add_block(block, *next);
      add_excluded(range);
      while (next != end && *next < range.end) ++next;
    }
    for (; next != end; ++next) add_block(block, *next);
    counts.push_back(static_cast<std::uint32_t>(entries.size()));
    return true;
  }
  std::size_t bytes() const {
    return entries.size() * sizeof(ExcludedPairs::Entry) + masks.size() * sizeof(std::uint64_t);
  }

  std::vector<std::uint32_t> counts;  // number of entries after each row
  std::vector<ExcludedPairs::Entry> entries;
  std::vector<std::uint64_t> masks;

 private:
  /// The blocks, from the row's own block on, that may have an excluded pair with it, ascending. find_partners() fills
  /// it for each row.
  struct Partners {
    std::vector<BlockRange> excluded;     // blocks whose pairs are all excluded
    std::vector<std::uint32_t> in_doubt;  // blocks that may have both an excluded pair and one that is not
  };

  void find_partners(std::uint32_t block) {
    std::vector<std::uint32_t>& in_doubt = partners_.in_doubt;
    in_doubt.clear(), partners_.excluded.clear();
    for (const std::uint32_t v : rings_.reached())
      for (const std::uint32_t b : source_.blocks_of_vertices.of(v))
        if (b >= block) in_doubt.push_back(b);
    source_.boxes.find(source_.test, block, partners_.excluded, in_doubt);
    std::sort(in_doubt.begin(), in_doubt.end());
    in_doubt.erase(std::unique(in_doubt.begin(), in_doubt.end()), in_doubt.end());
  }

  /// Excludes all pairs of the row's block with these blocks.
  void add_excluded(const BlockRange& range) {
    const bool is_next = entries.size() > row_ && entries.back().masks == ExcludedPairs::no_masks &&
                         entries.back().last + 1 == range.begin;
    if (is_next) {
      entries.back().last = range.end - 1;
    } else {
      entries.push_back({range.begin, range.end - 1, ExcludedPairs::no_masks});
    }
  }

  void add_block(std::uint32_t a, std::uint32_t b) {
    const std::size_t first = masks.size();
    places_b_.take(source_.surface, b, source_.rule.features);
    places_b_.join([&](std::uint32_t v) { return rings_.reached_from(v); });
    add_masks(a == b);
    const auto are = [&](std::uint64_t bits) {
      return std::all_of(masks.begin() + static_cast<std::ptrdiff_t>(first), masks.end(),
                         [&](std::uint64_t mask) { return mask == bits; });
    };
    const bool are_all = are(all_bits), are_none = are(0);
    if (!are_all && !are_none) entries.push_back({b, b, static_cast<std::uint32_t>(first)});
    if (are_all || are_none) masks.resize(first);
    if (are_all) add_excluded({b, b + 1});
  }

  void add_masks(bool is_one_block) {
    const BlockPlaces &a = places_a_, &b = places_b_;
    const auto ordered = [](PairKind kind, std::uint32_t x, std::uint32_t y) {
      return FeaturePair{kind, std::min(x, y), std::max(x, y)};
    };
    if (source_.rule.features == Features::facets) {
      add_masks(a.facets, b.facets,
                [&](std::uint32_t f, std::uint32_t g) { return ordered(PairKind::facet_facet, f, g); });
      return;
    }
    add_masks(a.vertices, b.facets, [](std::uint32_t v, std::uint32_t f) {
      return FeaturePair{PairKind::vertex_facet, v, f};
    });
    if (!is_one_block)
      add_masks(a.facets, b.vertices, [](std::uint32_t f, std::uint32_t v) {
        return FeaturePair{PairKind::vertex_facet, v, f};
      });
    add_masks(a.edges, b.edges, [&](std::uint32_t e, std::uint32_t f) { return ordered(PairKind::edge_edge, e, f); });
  }

  /// Places without a feature count as excluded, and so do pairs that share a vertex, which no search finds.
  template <class Pair>
  void add_masks(const std::vector<Place>& a, const std::vector<Place>& b, const Pair& pair) {
    const std::size_t groups_a = (a.size() + 7) / 8, groups_b = (b.size() + 7) / 8, first = masks.size();
    masks.resize(first + groups_a * groups_b, all_bits);
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < b.size(); ++j)
        if (!excludes(a[i], b[j], pair))
          masks[first + i / 8 * groups_b + j / 8] &= ~(std::uint64_t{1} << (i % 8 * 8 + j % 8));
  }
  template <class Pair>
  bool excludes(const Place& a, const Place& b, const Pair& pair) const {
    if ((a.corners & b.joined) != 0) return true;
    if (source_.test.are_surely_apart(a.box, b.box)) return false;
    return source_.test.are_surely_near(a.box, b.box) || source_.test.are_near_at_rest(pair(a.number, b.number));
  }

  const ExclusionSource& source_;
  BlockRings rings_;
  Partners partners_;
  std::size_t row_ = 0;              // begin of the row's entries
  BlockPlaces places_a_, places_b_;  // places of the row's block and of the block that is added
};

ExcludedPairs::ExcludedPairs(const SurfaceTreeState& s, const ExclusionRule& rule, Workers& workers, Table table)
    : rule_(rule), boxes_(s) {
  const ExclusionRule in_rows{rule.rings, table == Table::whole ? rule.rest_distance : 0, rule.features};
  if (in_rows.excludes_any()) make_rows(s, in_rows, workers);
  if (rule.rest_distance > 0 && !(is_kept_ && table == Table::whole))
    points_ = RestPoints(s, rule.rest_distance, ExclusionTest(s, rule).rounding(), rule.features);
}

void ExcludedPairs::make_rows(const SurfaceTreeState& s, const ExclusionRule& rule, Workers& workers) {
  const ExclusionSource source(s, rule, boxes_);
  const std::size_t blocks = s.block_count(), most_bytes = most_bytes_per_facet * s.blocks.order.size();
  // There are few parts, because each holds a number per vertex.
  const std::size_t blocks_at_once = std::max<std::size_t>(16, (blocks + 63) / 64);
  std::vector<std::optional<ExclusionRows>> parts((blocks + blocks_at_once - 1) / blocks_at_once);
  std::atomic<std::size_t> bytes = 0;
  std::atomic<bool> is_too_large = false;
  parallel_for(workers, blocks, blocks_at_once, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    ExclusionRows& rows = parts[begin / blocks_at_once].emplace(source);
    for (std::size_t block = begin; block < end && !is_too_large; ++block) {
      check_interrupt();
      const std::size_t before = rows.bytes();
      // mutant exclusion-memory: `most_bytes` -> `100 * most_bytes`
      if (!rows.add(static_cast<std::uint32_t>(block)) || (bytes += rows.bytes() - before) > most_bytes)
        is_too_large = true;
    }
  });
  // The sum over the same rows is the same in every order.
  is_kept_ = !is_too_large;
  if (!is_kept_) return;
  begin_.push_back(0);
  for (const std::optional<ExclusionRows>& rows : parts) {
    const auto first_entry = static_cast<std::uint32_t>(entries_.size());
    const auto first_mask = static_cast<std::uint32_t>(masks_.size());
    for (const std::uint32_t count : rows->counts) begin_.push_back(first_entry + count);
    for (const Entry& entry : rows->entries)
      entries_.push_back({entry.first, entry.last, entry.masks == no_masks ? no_masks : first_mask + entry.masks});
    masks_.insert(masks_.end(), rows->masks.begin(), rows->masks.end());
  }
  entries_.shrink_to_fit(), masks_.shrink_to_fit();
  make_nodes(most_bytes);
}

void ExcludedPairs::make_nodes(std::size_t most_bytes) {
  std::vector<std::uint32_t> begin{0};
  std::vector<ExcludedNodes::Run> runs;
  for (std::size_t row = 0; row + 1 < begin_.size(); ++row) {
    for (std::uint32_t i = begin_[row]; i < begin_[row + 1]; ++i)
      if (entries_[i].masks == no_masks) runs.push_back({entries_[i].first, entries_[i].last});
    begin.push_back(static_cast<std::uint32_t>(runs.size()));
  }
  const std::size_t used = bytes();
  nodes_ = ExcludedNodes(std::move(begin), std::move(runs), most_bytes > used ? most_bytes - used : 0);
}

// A box holds all vertices of the facets below its node, and so every point of the features of its blocks. Where
// are_surely_near() is true of two boxes, are_near_at_rest() is true of all pairs of features in them.
bool ExcludedPairs::are_all(const SurfaceTreeState& s, const BoxNode& a, const BoxNode& b) const {
  if (is_kept_ && (a.is_block() ? are_all(of(a.number, b.number)) : nodes_.hold(a.height, a.number, b.number)))
    return true;
  return ExclusionTest(s, rule_).are_surely_near(boxes_.of(a), boxes_.of(b));
}

std::size_t ExcludedPairs::bytes() const {
  return begin_.size() * sizeof(begin_[0]) + entries_.size() * sizeof(Entry) + masks_.size() * sizeof(masks_[0]) +
         nodes_.bytes() + points_.bytes();
}

const std::uint64_t* ExcludedPairs::of(std::uint32_t a, std::uint32_t b) const {
  if (!is_kept_) return none_;
  const auto begin = entries_.begin() + begin_[a], end = entries_.begin() + begin_[a + 1];
  const auto at =
      std::lower_bound(begin, end, b, [](const Entry& entry, std::uint32_t block) { return entry.last < block; });
  // mutant exclusion-run: `end || b < at->first` -> `end`
  if (at == end || b < at->first) return none_;
  return at->masks == no_masks ? all_ : &masks_[at->masks];
}

namespace {

std::shared_ptr<const ExcludedPairs> find_table(ExclusionTables& tables, const ExclusionRule& rule) {
  const std::lock_guard lock(tables.mutex);
  const auto at = std::find_if(tables.latest_first.begin(), tables.latest_first.end(),
                               // mutant exclusion-rule: `() == rule` -> `().features == rule.features`
                               [&](const auto& table) { return table->rule() == rule; });
  if (at == tables.latest_first.end()) return nullptr;
  std::rotate(tables.latest_first.begin(), at, at + 1);
  return tables.latest_first.front();
}

}  // namespace

std::shared_ptr<const ExcludedPairs> excluded_pairs(const SurfaceTreeState& surface, const ExclusionRule& rule,
                                                    Workers& workers) {
  constexpr std::size_t most_tables = 4;
  ExclusionTables& tables = *surface.exclusions;
  if (auto found = find_table(tables, rule)) return found;
  // The lock is not held here, because workers may do other work for this surface in between. Two threads may make the
  // same table.
  auto made = std::make_shared<const ExcludedPairs>(surface, rule, workers, ExcludedPairs::Table::rings);
  if (auto found = find_table(tables, rule)) return found;
  const std::lock_guard lock(tables.mutex);
  tables.latest_first.insert(tables.latest_first.begin(), made);
  if (tables.latest_first.size() > most_tables) tables.latest_first.pop_back();
  return made;
}

}  // namespace morula::detail
