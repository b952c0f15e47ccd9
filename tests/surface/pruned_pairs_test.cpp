// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Searches that leave out pairs of nodes whose features a filter excludes: against runs counted block by block, and
// against queries that find all pairs and drop the excluded ones afterwards, by hops and distances of their own.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <queue>

#include "surface/pairs/excluded_nodes.hpp"
#include "surface/pairs/excluded_pairs.hpp"
#include "surface/pairs/feature_filter.hpp"
#include "surfaces.hpp"

namespace morula {
namespace {

using detail::ExcludedNodes;
using detail::ExcludedPairs;
using detail::Features;

/// For every pair of blocks a <= b, whether it is excluded, at a b.
using Excluded = std::vector<std::vector<bool>>;

Excluded random_blocks(std::uint32_t count, Random& random) {
  Excluded excluded(count, std::vector<bool>(count));
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = a; b < count; ++b) excluded[a][b] = true;
  // A few holes, so that most pairs of nodes have none.
  const std::size_t holes = static_cast<std::size_t>(random.uniform(0, 12));
  for (std::size_t k = 0; k < holes; ++k) {
    const auto a = static_cast<std::uint32_t>(random.uniform(0, count));
    const auto b = static_cast<std::uint32_t>(random.uniform(a, count));
    const auto end = std::min<std::uint32_t>(count, b + static_cast<std::uint32_t>(random.uniform(1, 20)));
    for (std::uint32_t i = b; i < end; ++i) excluded[a][i] = false;
  }
  return excluded;
}

TEST(ExcludedNodes, hold_the_pairs_of_which_every_pair_of_blocks_is_excluded) {
  Random random(11);
  std::size_t held = 0, open = 0;
  for (const std::uint32_t count : {1u, 2u, 7u, 8u, 9u, 16u, 63u, 64u, 65u, 100u, 513u})
    for (int round = 0; round < 8; ++round) {
      const Excluded excluded = random_blocks(count, random);
      std::vector<std::uint32_t> begin{0};
      std::vector<ExcludedNodes::Run> runs;
      for (std::uint32_t a = 0; a < count; ++a) {
        for (std::uint32_t b = a; b < count; ++b) {
          if (!excluded[a][b]) continue;
          if (runs.size() > begin.back() && runs.back().last + 1 == b)
            runs.back().last = b;
          else
            runs.push_back({b, b});
        }
        begin.push_back(static_cast<std::uint32_t>(runs.size()));
      }
      const ExcludedNodes nodes(begin, runs, 1u << 30), none(begin, runs, 0);
      std::uint32_t height = 1;
      for (std::uint32_t size = 8; height < 5; size *= 8, ++height) {
        const std::uint32_t in_height = (count + size - 1) / size;
        for (std::uint32_t a = 0; a < in_height; ++a)
          for (std::uint32_t b = a; b < in_height; ++b) {
            bool all = true;
            for (std::uint32_t x = a * size; x < std::min(count, (a + 1) * size); ++x)
              for (std::uint32_t y = std::max(x, b * size); y < std::min(count, (b + 1) * size); ++y)
                all = all && excluded[x][y];
            ASSERT_EQ(nodes.hold(height, a, b), all && count > size / 8)
                << count << " blocks, height " << height << ": " << a << ' ' << b;
            ASSERT_FALSE(none.hold(height, a, b));
            (all ? held : open) += 1;
          }
        if (in_height == 1) break;
      }
    }
  EXPECT_GT(held, 1000u);
  EXPECT_GT(open, 100u);
}

/// Hops along edges from one vertex to all, far ones last.
std::vector<std::uint32_t> hops_from(const Mesh& mesh, std::uint32_t start) {
  std::vector<std::vector<std::uint32_t>> next(mesh.vertex_count());
  for (const test::Vertices& e : test::plain_edges(mesh)) next[e[0]].push_back(e[1]), next[e[1]].push_back(e[0]);
  std::vector<std::uint32_t> hops(mesh.vertex_count(), 1u << 30);
  std::queue<std::uint32_t> queue;
  hops[start] = 0;
  for (queue.push(start); !queue.empty(); queue.pop())
    for (const std::uint32_t w : next[queue.front()])
      if (hops[w] == 1u << 30) hops[w] = hops[queue.front()] + 1, queue.push(w);
  return hops;
}

/// The pairs that a filter keeps, by hops and distances of its own. Pairs within rounding of the distance are kept, and
/// put into `unsure`.
class Kept {
 public:
  explicit Kept(const Mesh& mesh) : mesh_(mesh) {
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) hops_.push_back(hops_from(mesh, v));
  }
  enum class Answer { kept, dropped, unsure };
  Answer of(const test::PlainPair& pair, const PairFilter& filter) const {
    for (const std::uint32_t v : pair.a)
      for (const std::uint32_t w : pair.b)
        if (filter.rings > 0 && hops_[v][w] <= filter.rings) return Answer::dropped;
    if (filter.rest_distance == 0) return Answer::kept;
    const long double distance = test::plain_distance(mesh_.positions, pair.a, pair.b);
    if (std::abs(distance - filter.rest_distance) < 1e-12L) return Answer::unsure;
    return distance < filter.rest_distance ? Answer::dropped : Answer::kept;
  }

 private:
  const Mesh& mesh_;
  std::vector<std::vector<std::uint32_t>> hops_;
};

void expect_pairs_of(const Kept& kept, const PairFilter& filter, const std::vector<test::PlainPair>& all,
                     const std::vector<test::PlainPair>& found) {
  for (const test::PlainPair& pair : all) {
    const bool is_found = std::binary_search(found.begin(), found.end(), pair);
    const Kept::Answer answer = kept.of(pair, filter);
    if (answer == Kept::Answer::unsure) continue;
    ASSERT_EQ(is_found, answer == Kept::Answer::kept) << filter.rings << ' ' << filter.rest_distance;
  }
  ASSERT_LE(found.size(), all.size());
}

struct Crumpled {
  Mesh mesh = sample_body("limb", 12);
  std::vector<Vec3> positions = deform(mesh, {Poke{.push = {0, 0, -0.5}, .radius = 0.5}, Bend{60}}, 1.0);
  double size = bounding_box(mesh).diagonal();
};

std::vector<PairFilter> filters_by_size(double size) {
  return {{.rest_distance = 0.02 * size}, {.rings = 3},
          {.rest_distance = 0.1 * size},  {.rings = 2, .rest_distance = 0.05 * size},
          {.rest_distance = 0.4 * size},  {.rings = 12},
          {.rest_distance = 5 * size},    {}};
}

// Options change from run to run, and budgets end runs; a search that leaves out nodes goes on to the same pairs.
TEST(PrunedPairs, are_those_of_all_pairs_that_the_filter_keeps) {
  const Crumpled body;
  SurfaceTree tree(body.mesh);
  ASSERT_TRUE(tree.update(body.positions));
  const Kept kept(body.mesh);
  ProximityOptions options{.distance = 0.03 * body.size};
  ProximityQuery plain(options), again(options);
  ASSERT_TRUE(plain.run(tree).finished);
  const auto all = test::plain_pairs(tree, tree, plain.pairs());
  ASSERT_GT(all.size(), 3000u);
  for (int round = 0; round < 2; ++round)
    for (const PairFilter& filter : filters_by_size(body.size)) {
      options.filter = filter;
      again.set_options(options);
      Workers workers(round == 0 ? 1 : 3);
      ASSERT_TRUE(again.run(tree, workers).finished);
      const std::vector<ProximityPair> found(again.pairs().begin(), again.pairs().end());
      expect_pairs_of(kept, filter, all, test::plain_pairs(tree, tree, found));
      if (testing::Test::HasFatalFailure()) return;
      ProximityOptions by_budget = options;
      by_budget.budget = 6400;
      ProximityQuery bit_by_bit(by_budget);
      SurfaceQueryStatus status = bit_by_bit.run(tree);
      for (int calls = 0; status && !status.finished && calls < 100000; ++calls) status = bit_by_bit.resume();
      ASSERT_TRUE(status.finished);
      ASSERT_TRUE(std::equal(found.begin(), found.end(), bit_by_bit.pairs().begin(), bit_by_bit.pairs().end(),
                             [](const ProximityPair& p, const ProximityPair& q) {
                               return p == q && p.distance == q.distance && p.point_a == q.point_a;
                             }));
    }
}

// A resumed query reads the filter again: each pair is decided by the filter of the call that comes to it.
TEST(PrunedPairs, of_calls_with_several_filters_are_decided_by_one_of_them) {
  const Crumpled body;
  SurfaceTree tree(body.mesh);
  ASSERT_TRUE(tree.update(body.positions));
  const Kept kept(body.mesh);
  const std::vector<PairFilter> filters = filters_by_size(body.size);
  ProximityOptions options{.distance = 0.03 * body.size};
  ProximityQuery plain(options);
  ASSERT_TRUE(plain.run(tree).finished);
  const auto all = test::plain_pairs(tree, tree, plain.pairs());
  for (std::size_t first = 0; first < filters.size(); ++first) {
    const PairFilter &one = filters[first], &other = filters[(first + 3) % filters.size()];
    options.budget = 64000;
    options.filter = one;
    ProximityQuery query(options);
    SurfaceQueryStatus status = query.run(tree);
    for (int calls = 1; status && !status.finished && calls < 100000; ++calls) {
      options.filter = calls % 2 == 0 ? one : other;
      query.set_options(options);
      status = query.resume();
    }
    ASSERT_TRUE(status.finished);
    const auto found = test::plain_pairs(tree, tree, query.pairs());
    for (const test::PlainPair& pair : all) {
      const bool is_found = std::binary_search(found.begin(), found.end(), pair);
      const Kept::Answer by_one = kept.of(pair, one), by_other = kept.of(pair, other);
      if (by_one == by_other && by_one != Kept::Answer::unsure) {
        ASSERT_EQ(is_found, by_one == Kept::Answer::kept) << first;
      }
    }
  }
}

// Without a table only the boxes at rest decide of nodes: all pairs below them are excluded one by one as well, also
// where a unit is all that coordinates can resolve.
TEST(PrunedPairs, of_nodes_without_a_table_are_excluded_one_by_one) {
  Random random(5);
  constexpr std::uint32_t facets = 120;
  std::size_t held = 0, open = 0;
  for (const double far : {0.0, 0x1p51}) {
    Mesh mesh;
    const auto whole = [&](double r) { return std::floor(random.uniform(-r, r + 1)); };
    for (std::uint32_t f = 0; f < facets; ++f) {
      const Vec3 middle{whole(20), whole(20), whole(20)};
      for (int k = 0; k < 3; ++k)
        mesh.positions.push_back(middle + Vec3{whole(20) + far, whole(20) + far, whole(20) - far});
      mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    }
    const SurfaceTree tree(mesh);
    const detail::SurfaceTreeState& s = detail::state_of(tree);
    for (double r = 60; r < 200; r += 3.3) {
      const ExcludedPairs table(s, {0, r, Features::all}, serial_workers());
      const detail::ExclusionTest test(s, {0, r, Features::all});
      for (std::uint32_t a = 0; a < s.block_count(); ++a)
        for (std::uint32_t b = a; b < s.block_count(); ++b) {
          const bool are_all = table.are_all(s, {a, 0}, {b, 0}, true);
          (are_all ? held : open) += 1;
          if (!are_all) continue;
          for (std::uint32_t i = 8 * a; i < std::min<std::uint32_t>(8 * a + 8, facets); ++i)
            for (std::uint32_t j = 8 * b; j < std::min<std::uint32_t>(8 * b + 8, facets); ++j)
              for (const std::uint32_t v : s.blocks.facets_in_order[i])
                ASSERT_TRUE(test.excludes({PairKind::vertex_facet, v, s.blocks.order[j]})) << far << ' ' << r;
        }
    }
  }
  EXPECT_GT(held, 100u);
  EXPECT_GT(open, 100u);
}

/// Features of two blocks in the order of their groups; `near` has the bits of each pair of groups.
template <class Check>
void check_groups(std::size_t count_a, std::size_t count_b, const detail::ShapeGroups& a, const detail::ShapeGroups& b,
                  const detail::NearAtRest& near, const Check& check) {
  for (std::uint32_t i = 0; i < count_a; ++i)
    for (std::uint32_t j = 0; j < count_b; ++j) {
      const std::uint64_t bit = std::uint64_t{1} << (8 * (i % 8) + j % 8);
      check(near.near(a, i / 8, b, j / 8, bit) == bit, i, j);
      // Other bits do not change the answer, and bits that are not given are not returned.
      ASSERT_EQ(near.near(a, i / 8, b, j / 8, ~std::uint64_t{0}) & bit, near.near(a, i / 8, b, j / 8, bit));
      ASSERT_EQ(near.near(a, i / 8, b, j / 8, 0), 0u);
    }
}

/// Calls check(is_near, pair) for all pairs of features of all blocks.
template <class Check>
void check_all_pairs(const detail::SurfaceTreeState& s, const detail::NearAtRest& near, const Check& check) {
  detail::FeatureBoxes places;
  places.start(s, s.boxes, Features::all);
  const auto facets = [&](std::uint32_t k) {
    return std::min<std::size_t>(8, s.blocks.order.size() - 8 * std::size_t{k});
  };
  const auto edges = [&](std::uint32_t k) { return s.blocks.own_edges_begin[k + 1] - s.blocks.own_edges_begin[k]; };
  const auto vertices = [&](std::uint32_t k) { return s.blocks.own_vertices[k + 1] - s.blocks.own_vertices[k]; };
  const detail::RestShapes& of = near.shapes();
  for (std::uint32_t a = 0; a < s.block_count(); ++a)
    for (std::uint32_t b = a; b < s.block_count(); ++b) {
      check_groups(edges(a), edges(b), of.edges(a), of.edges(b), near, [&](bool is_near, auto i, auto j) {
        check(is_near, FeaturePair{PairKind::edge_edge, places.edge(a, i), places.edge(b, j)});
      });
      check_groups(vertices(a), facets(b), of.vertices(a), of.facets(b), near, [&](bool is_near, auto i, auto j) {
        check(is_near, FeaturePair{PairKind::vertex_facet, places.vertex(a, i), places.facet(b, j)});
      });
      check_groups(facets(a), vertices(b), of.facets(a), of.vertices(b), near, [&](bool is_near, auto i, auto j) {
        check(is_near, FeaturePair{PairKind::vertex_facet, places.vertex(b, j), places.facet(a, i)});
      });
      check_groups(facets(a), facets(b), of.facets(a), of.facets(b), near, [&](bool is_near, auto i, auto j) {
        check(is_near, FeaturePair{PairKind::facet_facet, places.facet(a, i), places.facet(b, j)});
      });
    }
}

test::Vertices vertices_of(const SurfaceTree& tree, const FeaturePair& pair, bool is_first) {
  if (pair.kind == PairKind::edge_edge) {
    const auto& e = tree.edges()[is_first ? pair.a : pair.b];
    return {e[0], e[1]};
  }
  if (pair.kind == PairKind::vertex_facet && is_first) return {pair.a};
  const Facet& f = tree.facets()[is_first ? pair.a : pair.b];
  return {f[0], f[1], f[2]};
}

// Shapes prove only what the distance of the pair confirms, wherever the body is and however small; and they prove
// nearly all of it.
TEST(RestShapes, are_near_only_where_their_features_are) {
  Random random(6);
  std::size_t near = 0, open = 0, missed = 0;
  for (int round = 0; round < 12; ++round) {
    Mesh mesh = test::random_soup(30, 40, 3, random).mesh;
    const double far = round % 4 == 0 ? 0 : std::ldexp(1.0, 17 + round % 4), unit = round < 6 ? 1 : 0x1p-90;
    for (Vec3& p : mesh.positions) {
      p = p + Vec3{far, 0, 0} + Vec3{0, 0.3 * random.uniform(), 0.3 * random.uniform()};
      p = p * unit;
    }
    const SurfaceTree tree(mesh);
    const detail::SurfaceTreeState& s = detail::state_of(tree);
    const auto shapes = std::make_shared<const detail::RestShapes>(s, Features::all, serial_workers());
    for (const double share : {0.01, 0.5, 1.0, 2.5}) {
      const double r = share * unit;
      const detail::NearAtRest at_rest(shapes, r, detail::ExclusionTest(s, {0, r, Features::all}).rounding());
      ASSERT_TRUE(at_rest.is_able());
      check_all_pairs(s, at_rest, [&](bool is_near, const FeaturePair& pair) {
        if (pair.kind == PairKind::facet_facet) {
          ASSERT_TRUE(!is_near || detail::are_within_at_rest(s, pair, r));
          return;
        }
        const long double distance =
            test::plain_distance(mesh.positions, vertices_of(tree, pair, true), vertices_of(tree, pair, false));
        (is_near ? near : open) += 1;
        ASSERT_TRUE(!is_near || distance <= r) << far << ' ' << r;
        missed += !is_near && distance < 0.99L * r ? 1 : 0;
      });
    }
  }
  EXPECT_GT(near, 10000u);
  EXPECT_GT(open, 10000u);
  EXPECT_LT(100 * missed, near);
}

// Squares of their sides underflow, and products with the squares of others lose all digits.
TEST(NearestPoints, of_needles_are_as_near_as_the_needles) {
  Random random(9);
  const auto near_zero = [&](double size) {
    return Vec3{size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1)};
  };
  for (const double size : {0x1p-240, 0x1p-300, 0x1p-500, 0x1p-525, 0x1p-533, 0x1p-537, 0x1p-545})
    for (int round = 0; round < 400; ++round) {
      // Vertices 0 to 2: a needle of one long side; 3 to 5: any facet, in every second round a needle as well.
      std::vector<Vec3> p{near_zero(size), near_zero(size), near_zero(1), near_zero(1), near_zero(1), near_zero(1)};
      if (round % 2 == 1) p[4] = p[3] = {}, p[3] = near_zero(size);
      std::swap(p[0], p[static_cast<std::size_t>(round / 2 % 3)]);
      const auto expect = [&](PairKind kind, const test::Vertices& a, const test::Vertices& b) {
        std::vector<Vec3> in_a, in_b;
        for (const std::uint32_t v : a) in_a.push_back(p[v]);
        for (const std::uint32_t v : b) in_b.push_back(p[v]);
        const ProximityPair found = detail::nearest_points({kind, 0, 0}, in_a, in_b);
        ASSERT_NEAR(found.distance, static_cast<double>(test::plain_distance(p, a, b)), 0x1p-46)
            << size << ' ' << round;
      };
      for (std::uint32_t i = 0; i < 3; ++i) {
        expect(PairKind::vertex_facet, {i}, {3, 4, 5}), expect(PairKind::vertex_facet, {3 + i}, {0, 1, 2});
        for (std::uint32_t j = 0; j < 3; ++j) expect(PairKind::edge_edge, {i, (i + 1) % 3}, {3 + j, 3 + (j + 1) % 3});
      }
    }
}

// All in one plane but for the needles' width, so that feet of the others lie within the needles.
TEST(NearestPoints, of_needles_under_a_feature_are_as_near_as_in_the_plane) {
  Random random(9);
  for (const double size : {0x1p-500, 0x1p-525, 0x1p-533, 0x1p-536})
    for (int round = 0; round < 400; ++round) {
      const auto flat = [&](double y, double z) { return Vec3{size * random.uniform(-1, 1), y, z}; };
      const double y = random.uniform(0, 1), z = random.uniform(0.5, 1);
      std::vector<Vec3> needle{flat(0, 0), flat(0, 0), flat(1, 0)};
      std::swap(needle[0], needle[static_cast<std::size_t>(round % 3)]);
      const std::vector<Vec3> above{flat(y, z)}, along{flat(0, 0), flat(1, 0)}, across{flat(y, z), flat(y, z)};
      ASSERT_NEAR(detail::nearest_points({PairKind::vertex_facet, 0, 0}, above, needle).distance, z, 0x1p-46) << size;
      ASSERT_NEAR(detail::nearest_points({PairKind::edge_edge, 0, 0}, along, across).distance, z, 0x1p-46) << size;
    }
}

TEST(RestShapes, of_all_processors_have_the_same_bits) {
  Random random(8);
  const float none = std::numeric_limits<float>::quiet_NaN();
  std::uint64_t some = 0;
  for (int round = 0; round < 2000; ++round) {
    detail::PointGroup a[3], b[3];
    for (detail::PointGroup* const group : {a, b})
      for (int corner = 0; corner < 3; ++corner)
        for (auto& axis : group[corner].at)
          for (float& x : axis)
            x = round % 5 == 0 && random.uniform() < 0.1 ? none
                : round % 3 == 0                         ? static_cast<float>(std::floor(random.uniform(0, 3)))
                                                         : static_cast<float>(random.uniform(-1, 1));
    const auto squared = static_cast<float>(random.uniform(0, 0.6));
    const std::uint64_t bits = random.next();
    const detail::NearShapes& plain = detail::all_near_shapes()[0];
    for (const auto kernel :
         {&detail::NearShapes::corners, &detail::NearShapes::edges, &detail::NearShapes::vertex_facets}) {
      const std::uint64_t expected = (plain.*kernel)(a, b, bits, squared);
      ASSERT_EQ(expected & ~bits, 0u);
      some |= expected;
      for (const detail::NearShapes& kernels : detail::all_near_shapes())
        ASSERT_EQ((kernels.*kernel)(a, b, bits, squared), expected);
    }
  }
  EXPECT_EQ(some, ~std::uint64_t{0});
}

// Facets and edges shrunk to points, so that their distance is that of the points, a little above the distance at rest.
TEST(RestShapes, pay_for_the_rounding_of_floats) {
  Random random(7);
  std::size_t checked = 0;
  Mesh mesh;
  for (std::uint32_t f = 0; f < 64; ++f) {
    const Vec3 here{random.uniform() + (f % 4 < 2 ? 1024 : 0), random.uniform(), 512 * (f % 2) + random.uniform()};
    mesh.positions.insert(mesh.positions.end(), 3, here);
    mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  const SurfaceTree tree(mesh);
  const detail::SurfaceTreeState& s = detail::state_of(tree);
  const auto shapes = std::make_shared<const detail::RestShapes>(s, Features::facets, serial_workers());
  for (std::uint32_t i = 0; i < 64; ++i)
    for (std::uint32_t j = i + 1; j < 64; ++j) {
      const Vec3 from = mesh.positions[s.blocks.facets_in_order[i][0]],
                 to = mesh.positions[s.blocks.facets_in_order[j][0]];
      const double r = length(to - from) * (1 - 0x1p-40);
      const detail::NearAtRest near(shapes, r, 0);
      if (!near.is_able()) continue;
      ++checked;
      const std::uint64_t bit = std::uint64_t{1} << (8 * (i % 8) + j % 8);
      ASSERT_EQ(near.near(shapes->facets(i / 8), 0, shapes->facets(j / 8), 0, bit), 0u) << length(to - from);
    }
  EXPECT_GT(checked, 1000u);
}

// Under a budget the search makes the rows of the table that it comes to, and no others.
TEST(PrunedPairs, of_rings_under_a_budget_need_no_table_made_before) {
  const Crumpled body;
  for (const std::uint32_t rings : {1u, 3u, 12u, 4000000000u}) {
    SurfaceTree whole(body.mesh), part(body.mesh);
    ASSERT_TRUE(whole.update(body.positions) && part.update(body.positions));
    ProximityOptions options{.distance = 0.03 * body.size, .filter = {.rings = rings}};
    ProximityQuery at_once(options);
    ASSERT_TRUE(at_once.run(whole).finished);
    options.budget = 640;
    ProximityQuery query(options);
    SurfaceQueryStatus status = query.run(part);
    const detail::ExclusionRule rule{rings, 0, Features::all};
    const auto table = [&](const SurfaceTree& tree) {
      return detail::excluded_pairs(detail::state_of(tree), rule, serial_workers());
    };
    const auto rows = [&](const SurfaceTree& tree) {
      std::uint32_t count = 0;
      for (std::uint32_t block = 0; block < detail::state_of(tree).block_count(); ++block)
        count += table(tree)->has_row(block) ? 1 : 0;
      return count;
    };
    EXPECT_EQ(rows(whole), detail::state_of(whole).block_count());
    EXPECT_LT(rows(part), 20u);
    const std::vector<ProximityPair> first(query.pairs().begin(), query.pairs().end());
    const std::size_t first_tests = status.box_tests;
    for (int calls = 0; status && !status.finished && calls < 100000; ++calls) status = query.resume();
    ASSERT_TRUE(status.finished);
    EXPECT_GT(rows(part), 20u);
    ASSERT_TRUE(std::equal(at_once.pairs().begin(), at_once.pairs().end(), query.pairs().begin(), query.pairs().end(),
                           [](const FeaturePair& p, const FeaturePair& q) { return p == q; }));
    // A budget in tests reaches the same pairs, whatever rows are there.
    status = query.run(part);
    EXPECT_EQ(status.box_tests, first_tests);
    ASSERT_TRUE(std::equal(first.begin(), first.end(), query.pairs().begin(), query.pairs().end(),
                           [](const FeaturePair& p, const FeaturePair& q) { return p == q; }));
  }
}

// The counts of tests are the same on every machine.
TEST(PrunedPairs, save_most_tests_where_nearly_all_near_pairs_are_excluded) {
  const Mesh mesh = sample_body("limb", 40);
  const double size = bounding_box(mesh).diagonal();
  SurfaceTree tree(mesh);
  ASSERT_TRUE(tree.update(deform(mesh, {Bend{20}}, 1.0)));
  ProximityQuery all({.distance = 0.06 * size});
  const SurfaceQueryStatus plain = all.run(tree);
  ASSERT_TRUE(plain.finished);
  for (const PairFilter& filter : {PairFilter{.rest_distance = 0.3 * size}, PairFilter{.rings = 16}}) {
    ProximityQuery query({.distance = 0.06 * size, .filter = filter});
    const SurfaceQueryStatus pruned = query.run(tree);
    ASSERT_TRUE(pruned.finished);
    EXPECT_LT(20 * query.pairs().size(), all.pairs().size());
    EXPECT_LT(2 * pruned.box_tests, plain.box_tests) << filter.rings;
  }
}

}  // namespace
}  // namespace morula
