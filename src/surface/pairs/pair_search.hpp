// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pair search: down two surface trees, or one against itself, to pairs of features whose boxes are near.
//
//   open pair of nodes        is replaced by
//   a, b of equal height      pairs of their children whose boxes are near
//   a higher than b           children of a whose boxes are near b's, each with b; and the other way round
//   a with itself each child with itself, and pairs of two children as above; nothing if a is proven to
//                             be a height field
//   two nodes of which every pair of features is excluded   nothing
//   two blocks                pairs of features, which are compared group by group
#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <morula/surface/feature_pairs.hpp>
#include <vector>

#include "collide/pairs/meter.hpp"
#include "parallel/float_environment.hpp"
#include "surface/boxes/box_node.hpp"
#include "surface/boxes/feature_boxes.hpp"
#include "surface/boxes/lazy_boxes.hpp"
#include "surface/pairs/excluded_pairs.hpp"
#include "surface/pairs/height_fields.hpp"

namespace morula::detail {

/// The rest of a budget.
class SurfaceMeter {
 public:
  /// tests: number of box pairs in a test of one group.
  SurfaceMeter(const Budget& budget, const Clock& clock, std::size_t tests = 64);
  bool is_unlimited() const { return budget_.is_unlimited(); }
  /// Whether so many groups of boxes may be tested against as many others, 64 pairs each. Once false, it stays false.
  /// The first call returns false only if the budget is zero.
  bool try_spend(std::size_t groups);
  std::size_t groups_tested = 0;

 private:
  Budget budget_;
  const Clock* clock_;
  std::size_t tests_;
  std::chrono::nanoseconds start_{};
  std::size_t calls_ = 0;
  bool is_over_ = false;
};

/// It keeps its memory. A list of open pairs of nodes holds the pairs that are not compared yet.
class PairSearch {
 public:
  /// Starts a search; of one surface with itself if b is a. reach: largest distance along each axis at which boxes
  /// still count as near, mesh units. by_spheres: for surfaces that follow bodies, pairs whose features are farther
  /// apart than the reach may be missing.
  void start(const SurfaceTreeState& a, const SurfaceTreeState& b, double reach, Features features, bool by_spheres,
             Workers& workers);
  /// For one surface with itself: the pairs to leave out; null if there are none. The table has to live until the last
  /// run().
  void exclude(const ExcludedPairs* excluded) { excluded_ = excluded; }
  bool is_started() const { return a_.surface != nullptr; }
  /// Whether the surfaces have not moved since the start.
  bool is_current() const { return static_cast<bool>(moved(Status::Code::other_frame)); }
  /// ok, or `code` with the number of the first surface that has moved since.
  Status moved(Status::Code code) const {
    if (!a_.is_current(0)) return {code, 0};
    if (!is_with_itself() && !b_.is_current(1)) return {code, 1};
    return {};
  }
  bool is_with_itself() const { return b_.surface == a_.surface; }
  const QueryBoxes& boxes() const { return boxes_; }
  const SurfaceTreeState& a() const { return *a_.surface; }
  const SurfaceTreeState& b() const { return *b_.surface; }

  /// Calls find(chunk, pair) for pairs of features whose boxes are near and, for one surface with itself, that share no
  /// vertex. Calls look(chunk) after several of them, and always after the last ones. The calls for one chunk are made
  /// one after the other, the calls for different chunks at the same time. Chunks are numbered from 0 on; chunks(count)
  /// is called before any of them. Every pair is found once, over all calls since start(). True when nothing is left to
  /// do.
  template <class Chunks, class Find, class Look>
  bool run(SurfaceMeter& meter, Workers& workers, const Chunks& chunks, const Find& find, const Look& visit);

  void open(std::vector<OpenFacets>& facets) const;

 private:
  struct NodePair {
    BoxNode a, b;
    bool is_pair_of_blocks() const { return a.is_block() && b.is_block(); }
  };
  struct BlockPair {
    std::uint32_t a, b;
  };

  bool is_node_with_itself(const NodePair& pair) const { return is_with_itself() && pair.a == pair.b; }
  /// Whether crossings of these facets with each other are sought and the facets have a border that can be tested.
  bool may_be_height_field(const NodePair& pair) const {
    return is_node_with_itself(pair) && finds_crossings_ && !pair.a.is_block();
  }
  bool is_height_field(const NodePair& pair) const {
    return may_be_height_field(pair) && fields_.is_one(pair.a.height, pair.a.number);
  }
  bool is_excluded(const NodePair& pair) const {
    return excluded_ != nullptr && excluded_->are_all(a(), pair.a, pair.b);
  }
  /// If a budget bounds the work, only the smallest regions are tested.
  bool is_sought_now(const NodePair& pair) const { return may_be_height_field(pair) && pair.a.height == 1; }
  /// Groups to be tested for a pair of nodes.
  std::size_t cost(const NodePair& pair) const {
    // The cost of testing 64 facets and their border, groups.
    constexpr std::size_t of_field = 32;
    if (pair.is_pair_of_blocks()) return cost(BlockPair{pair.a.number, pair.b.number});
    return is_sought_now(pair) ? 1 + of_field : 1;
  }
  std::size_t cost(const BlockPair& pair) const;
  /// Adds the pairs that replace a pair that is no pair of blocks, the last one first.
  void expand(const NodePair& pair, std::vector<NodePair>& below) const;
  void find_block_pairs(SurfaceMeter& meter, Workers& workers);
  template <class Find, class Look>
  void run_within_budget(SurfaceMeter& meter, const Find& find, const Look& visit);
  FeatureBoxes& boxes_b() { return is_with_itself() ? a_.boxes : b_.boxes; }
  const FeatureBoxes& boxes_b() const { return is_with_itself() ? a_.boxes : b_.boxes; }
  void want(const BlockPair& pair) {
    a_.boxes.want(pair.a);
    boxes_b().want(pair.b);
  }
  void fill_boxes(Workers& workers) {
    a_.boxes.fill(workers);
    if (!is_with_itself()) b_.boxes.fill(workers);
  }

  /// Calls find(pair) for pairs of features of two blocks whose boxes are near.
  template <class Find>
  void compare(const BlockPair& pair, const Find& find) const;
  template <class Find>
  void compare_facets(const BlockPair& pair, const std::uint64_t* excluded, const Find& find) const;
  template <class Find>
  void compare_vertices_and_edges(const BlockPair& pair, const std::uint64_t* excluded, const Find& find) const;
  template <class Find>
  void compare_edges(const BlockPair& pair, const std::uint64_t* excluded, const Find& find) const;
  /// The points at rest of the groups of two features of blocks; null without any.
  struct Points {
    const PointGroup *a = nullptr, *b = nullptr;
  };
  template <class Of>
  Points points(const BlockPair& pair, const Of& of_a, const Of& of_b) const {
    const RestPoints* const all = excluded_ != nullptr ? excluded_->points() : nullptr;
    return all == nullptr ? Points{} : Points{(all->*of_a)(pair.a), (all->*of_b)(pair.b)};
  }
  /// Tests all groups of i against all of j. excluded: 64 bits for each i and j, and the end of all these masks.
  template <class GroupA, class GroupB, class Found>
  void compare_groups(std::uint32_t groups_a, const GroupA& group_a, std::uint32_t groups_b, const GroupB& group_b,
                      const Points& points, const std::uint64_t*& excluded, const Found& found) const {
    for (std::uint32_t i = 0; i < groups_a; ++i)
      for (std::uint32_t j = 0; j < groups_b; ++j, ++excluded) {
        std::uint64_t bits = are_near_(group_a(i), group_b(j)) & ~*excluded;
        if (bits != 0 && points.a != nullptr) bits &= ~excluded_->points()->are_near(points.a[i], points.b[j]);
        for (; bits != 0; bits &= bits - 1) {
          const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
          found(8 * i + bit / 8, 8 * j + bit % 8);
        }
      }
  }

  /// One of the two surfaces, in its state when start() filled it; fill_boxes() makes the requested boxes.
  struct Side {
    const SurfaceTreeState* surface = nullptr;
    std::shared_ptr<const SurfaceTreeState> kept;  // keeps the state, if a SurfaceTree owns it
    std::uint64_t frame = 0;
    FeatureBoxes boxes;

    void start(const SurfaceTreeState& s);
    bool is_current(std::uint8_t body) const { return surface->frame == frame && surface->askable(body); }
  };
  /// The test by which boxes count as near; start() fills it.
  struct NearTest {
    MeetGroups meet = nullptr;
    BoxReach reach{};
    std::uint64_t operator()(const BoxGroup& group_a, const BoxGroup& group_b) const {
      return meet(group_a, group_b, reach);
    }
  };
  /// Memory of find_block_pairs(), which fills it on each call: pairs of nodes of one level, then tasks that descend
  /// from them, then the pairs of blocks of all tasks.
  struct BlockDescent {
    struct Task {
      std::vector<NodePair> stack;
      std::vector<BlockPair> pairs;
      std::size_t tests = 0;
    };
    std::vector<NodePair> level, below;
    std::vector<Task> tasks;
    std::vector<BlockPair> pairs;
  };

  Side a_, b_;  // for one surface with itself both refer to it, and b_ has no boxes
  Features features_ = Features::all;
  bool finds_crossings_ = false;  // pairs of facets that may intersect, and no others
  NearTest are_near_;
  QueryBoxes boxes_;
  const ExcludedPairs* excluded_ = nullptr;
  HeightFields fields_;
  std::vector<NodePair> open_;
  BlockDescent descent_;
};

/// This has no branches, which would be unpredictable.
inline bool share_a_vertex(const Facet& f, const Facet& g) {
  unsigned common = 0;
  for (const std::uint32_t v : g)
    common += static_cast<unsigned>(f[0] == v) + static_cast<unsigned>(f[1] == v) + static_cast<unsigned>(f[2] == v);
  return common != 0;
}

template <class Find>
void PairSearch::compare(const BlockPair& pair, const Find& find) const {
  const std::uint64_t* const excluded = excluded_ != nullptr ? excluded_->of(pair.a, pair.b) : ExcludedPairs::none();
  if (ExcludedPairs::are_all(excluded)) return;
  if (features_ == Features::facets)
    compare_facets(pair, excluded, find);
  else
    compare_vertices_and_edges(pair, excluded, find);
}

template <class Find>
void PairSearch::compare_facets(const BlockPair& pair, const std::uint64_t* excluded, const Find& find) const {
  const std::uint32_t a = pair.a, b = pair.b;
  const FeatureBoxes &in_a = a_.boxes, &in_b = boxes_b();
  const bool with_itself = is_with_itself(), one_block = with_itself && a == b;
  const auto facets_of_a = [&](std::uint32_t) -> const BoxGroup& { return in_a.facets(a); };
  const auto facets_of_b = [&](std::uint32_t) -> const BoxGroup& { return in_b.facets(b); };
  const Points at_rest = points(pair, &RestPoints::facets, &RestPoints::facets);
  compare_groups(1, facets_of_a, 1, facets_of_b, at_rest, excluded, [&](std::uint32_t i, std::uint32_t j) {
    if (one_block && i >= j) return;
    std::uint32_t f = in_a.facet(a, i), g = in_b.facet(b, j);
    if (with_itself) {
      const Facet &of_a = in_a.facet_corners(a, i), &of_b = in_b.facet_corners(b, j);
      if (share_a_vertex(of_a, of_b)) return;
      if (f > g) std::swap(f, g);
    }
    find(FeaturePair{PairKind::facet_facet, f, g});
  });
}

// Compares vertices of a with facets of b, facets of a with vertices of b, edges with edges: in the order of
// ExcludedPairs.
template <class Find>
void PairSearch::compare_vertices_and_edges(const BlockPair& pair, const std::uint64_t* excluded,
                                            const Find& find) const {
  const std::uint32_t a = pair.a, b = pair.b;
  const FeatureBoxes &in_a = a_.boxes, &in_b = boxes_b();
  const bool with_itself = is_with_itself(), one_block = with_itself && a == b;
  const auto has = [](const Facet& f, std::uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; };
  const auto facets_of_a = [&](std::uint32_t) -> const BoxGroup& { return in_a.facets(a); };
  const auto facets_of_b = [&](std::uint32_t) -> const BoxGroup& { return in_b.facets(b); };
  const auto vertices_of_a = [&](std::uint32_t i) -> const BoxGroup& { return in_a.vertices(a, i); };
  const auto vertices_of_b = [&](std::uint32_t i) -> const BoxGroup& { return in_b.vertices(b, i); };
  const Points vertices_first = points(pair, &RestPoints::vertices, &RestPoints::facets);
  const Points facets_first = points(pair, &RestPoints::facets, &RestPoints::vertices);
  compare_groups(in_a.vertex_groups(a), vertices_of_a, 1, facets_of_b, vertices_first, excluded,
                 [&](std::uint32_t i, std::uint32_t j) {
                   const std::uint32_t vertex = in_a.vertex(a, i);
                   if (with_itself && has(in_b.facet_corners(b, j), vertex)) return;
                   find(FeaturePair{PairKind::vertex_facet, vertex, in_b.facet(b, j)});
                 });
  if (!one_block) {
    compare_groups(1, facets_of_a, in_b.vertex_groups(b), vertices_of_b, facets_first, excluded,
                   [&](std::uint32_t i, std::uint32_t j) {
                     const std::uint32_t facet = in_a.facet(a, i), vertex = in_b.vertex(b, j);
                     if (with_itself) {
                       if (has(in_a.facet_corners(a, i), vertex)) return;
                       find(FeaturePair{PairKind::vertex_facet, vertex, facet});
                     } else {
                       find(FeaturePair{PairKind::facet_vertex, facet, vertex});
                     }
                   });
  }
  compare_edges(pair, excluded, find);
}

template <class Find>
void PairSearch::compare_edges(const BlockPair& pair, const std::uint64_t* excluded, const Find& find) const {
  const std::uint32_t a = pair.a, b = pair.b;
  const FeatureBoxes &in_a = a_.boxes, &in_b = boxes_b();
  const bool with_itself = is_with_itself(), one_block = with_itself && a == b;
  const auto edges_of_a = [&](std::uint32_t i) -> const BoxGroup& { return in_a.edges(a, i); };
  const auto edges_of_b = [&](std::uint32_t i) -> const BoxGroup& { return in_b.edges(b, i); };
  const Points at_rest = points(pair, &RestPoints::edges, &RestPoints::edges);
  compare_groups(in_a.edge_groups(a), edges_of_a, in_b.edge_groups(b), edges_of_b, at_rest, excluded,
                 [&](std::uint32_t i, std::uint32_t j) {
                   if (one_block && i >= j) return;
                   std::uint32_t e = in_a.edge(a, i), f = in_b.edge(b, j);
                   if (with_itself) {
                     const auto &of_a = in_a.edge_ends(a, i), &of_b = in_b.edge_ends(b, j);
                     if (of_a[0] == of_b[0] || of_a[0] == of_b[1] || of_a[1] == of_b[0] || of_a[1] == of_b[1]) return;
                     if (e > f) std::swap(e, f);
                   }
                   find(FeaturePair{PairKind::edge_edge, e, f});
                 });
}

// Takes one pair after the other, so that a budget in tests always reaches the same pairs.
template <class Find, class Look>
void PairSearch::run_within_budget(SurfaceMeter& meter, const Find& find, const Look& visit) {
  while (!open_.empty() && meter.try_spend(cost(open_.back()))) {
    const NodePair pair = open_.back();
    open_.pop_back();
    if (!pair.is_pair_of_blocks()) {
      if (is_sought_now(pair)) fields_.find(1, pair.a.number);
      expand(pair, open_);
      continue;
    }
    const BlockPair blocks{pair.a.number, pair.b.number};
    want(blocks);
    fill_boxes(serial_workers());
    compare(blocks, [&](const FeaturePair& found) { find(0, found); });
    visit(0);
  }
}

template <class Chunks, class Find, class Look>
bool PairSearch::run(SurfaceMeter& meter, Workers& workers, const Chunks& chunks, const Find& find, const Look& visit) {
  if (!meter.is_unlimited()) {
    chunks(1);
    run_within_budget(meter, find, visit);
    return open_.empty();
  }
  if (is_with_itself() && finds_crossings_) fields_.find_all(workers);
  find_block_pairs(meter, workers);
  const std::vector<BlockPair>& pairs = descent_.pairs;
  for (const BlockPair& pair : pairs) {
    want(pair);
    meter.groups_tested += cost(pair);
  }
  fill_boxes(workers);
  constexpr std::size_t pairs_at_once = 256;
  chunks((pairs.size() + pairs_at_once - 1) / pairs_at_once);
  parallel_for(workers, pairs.size(), pairs_at_once, [&](std::size_t begin, std::size_t end) {
    const StandardFloats standard;
    // The pairs between two calls of look(), few enough to stay in a small cache.
    constexpr std::size_t pairs_at_a_look = 32;
    const std::size_t chunk = begin / pairs_at_once;
    for (std::size_t i = begin; i < end; ++i) {
      compare(pairs[i], [&](const FeaturePair& found) { find(chunk, found); });
      if (i % pairs_at_a_look == 0 || i + 1 == end) visit(chunk);
    }
  });
  return true;
}

}  // namespace morula::detail
