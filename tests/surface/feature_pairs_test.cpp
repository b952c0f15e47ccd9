// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Proximity and crossings against brute force: whole, interrupted, filtered, by several workers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/connectivity.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <set>
#include <support/allocations.hpp>
#include <support/transforms.hpp>

#include "surfaces.hpp"

namespace morula {
namespace {

using test::Moving;
using test::plain_pairs;
using test::PlainPair;
using test::Vertices;

/// Pairs that are surely within and those that may be: distances of the query are rounded.
void expect_near_pairs(const std::vector<PlainPair>& found, const Mesh& mesh, const std::vector<Vec3>& at,
                       double distance) {
  const auto surely = test::pairs_with_itself(mesh, [&](const Vertices& a, const Vertices& b) {
    return test::plain_distance(at, a, b) <= distance * (1 - 1e-12L) - 1e-13L;
  });
  const auto maybe = test::pairs_with_itself(mesh, [&](const Vertices& a, const Vertices& b) {
    return test::plain_distance(at, a, b) <= distance * (1 + 1e-12L) + 1e-13L;
  });
  EXPECT_TRUE(std::includes(found.begin(), found.end(), surely.begin(), surely.end()));
  EXPECT_TRUE(std::includes(maybe.begin(), maybe.end(), found.begin(), found.end()));
}

TEST(Proximity, finds_what_brute_force_finds) {
  Random random(11);
  std::size_t total = 0;
  for (int round = 0; round < 60; ++round) {
    const Moving m = round % 3 == 0
                         ? test::wavy_sheet(4, 0.1, random)
                         : test::random_soup(12, 4 + static_cast<std::size_t>(round) % 40, 1 + round % 7, random);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.to));
    for (const double distance : {0.0, 0.04, 1.0}) {
      ProximityQuery query({.distance = distance});
      const SurfaceQueryStatus status = query.run(tree);
      ASSERT_TRUE(status && status.finished);
      const auto found = plain_pairs(tree, tree, query.pairs());
      const auto pairs = query.pairs();
      for (std::size_t i = 1; i < pairs.size(); ++i) ASSERT_LT(FeaturePair(pairs[i - 1]), FeaturePair(pairs[i]));
      expect_near_pairs(found, m.mesh, m.to, distance);
      total += found.size();
      for (const ProximityPair& pair : query.pairs()) {
        EXPECT_NEAR(length(pair.point_b - pair.point_a), pair.distance, 1e-12);
        double a = 0, b = 0;
        for (std::size_t k = 0; k < 3; ++k) a += pair.weights_a[k], b += pair.weights_b[k];
        EXPECT_NEAR(a, 1, 1e-12);
        EXPECT_NEAR(b, 1, 1e-12);
      }
    }
  }
  EXPECT_GT(total, 10000u);
}

TEST(Proximity, two_surfaces_are_those_of_their_union_across_pieces) {
  Random random(21);
  std::size_t total = 0;
  for (int round = 0; round < 20; ++round) {
    // Far from the origin, and the two origins far from each other.
    const Vec3 far{1e6, -3e5, 20.0 * round};
    const Mesh a = test::translated(test::icosphere(1 + round % 2, 1.0), far);
    const Mesh b = test::translated(test::uv_sphere(5 + round, 6, 0.8), far + test::random_point(random, 1.4));
    const Mesh both = test::joined(a, b);
    SurfaceTree tree_a(a), tree_b(b), tree_both(both);
    ProximityQuery across({.distance = 0.1}), within({.distance = 0.1, .filter = {.same_component = true}});
    ASSERT_TRUE(across.run(tree_a, tree_b));
    ASSERT_TRUE(within.run(tree_both));
    std::vector<PlainPair> found;
    const auto shift = static_cast<std::uint32_t>(a.positions.size());
    for (PlainPair pair : plain_pairs(tree_a, tree_b, across.pairs())) {
      for (std::uint32_t& v : pair.b) v += shift;
      found.push_back(test::plain_pair(pair.a, pair.b, true));
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, plain_pairs(tree_both, tree_both, within.pairs()));
    total += found.size();
  }
  EXPECT_GT(total, 1000u);
}

/// What is missing after an interruption is of facets that are open.
void expect_missing_is_open(const SurfaceTree& tree, std::span<const ProximityPair> found,
                            std::span<const ProximityPair> all, const std::vector<OpenFacets>& open) {
  std::set<FeaturePair> have(found.begin(), found.end());
  const auto has = [&](std::span<const std::uint32_t> facets, bool vertex, bool edge, std::uint32_t feature) {
    return std::any_of(facets.begin(), facets.end(), [&](std::uint32_t f) {
      const Facet& corners = tree.facets()[f];
      const auto contains = [&](std::uint32_t v) {
        return std::find(corners.begin(), corners.end(), v) != corners.end();
      };
      if (vertex) return contains(feature);
      if (edge) return contains(tree.edges()[feature][0]) && contains(tree.edges()[feature][1]);
      return f == feature;
    });
  };
  for (const ProximityPair& pair : all) {
    if (have.contains(pair)) continue;
    const bool edges = pair.kind == PairKind::edge_edge, vertex = !edges;
    EXPECT_TRUE(std::any_of(open.begin(), open.end(), [&](const OpenFacets& o) {
      return (has(o.a, vertex, edges, pair.a) && has(o.b, false, edges, pair.b)) ||
             (has(o.b, vertex, edges, pair.a) && has(o.a, false, edges, pair.b));
    }));
  }
}

TEST(Proximity, is_complete_at_every_interruption_and_goes_on_to_the_same_end) {
  Random random(31);
  const Moving m = test::wavy_sheet(9, 0.05, random);
  SurfaceTree tree(m.mesh);
  ASSERT_TRUE(tree.update(m.to));
  ProximityQuery whole({.distance = 0.02});
  const std::size_t tests = whole.run(tree).box_tests;
  ASSERT_FALSE(whole.pairs().empty());
  // Two blocks of eight facets have up to 3 groups of vertices each, and 3 of edges.
  constexpr std::int64_t one_piece = 64 * (3 + 3 + 3 * 3);
  for (const std::int64_t budget : {1, 64, 1000, 5000}) {
    ProximityQuery query({.distance = 0.02, .budget = budget});
    SurfaceQueryStatus status = query.run(tree);
    std::size_t done = status.box_tests, calls = 1;
    while (!status.finished) {
      EXPECT_GT(status.box_tests, 0u);
      EXPECT_LE(status.box_tests, static_cast<std::size_t>(std::max(budget, one_piece)));
      if (budget >= 64) expect_missing_is_open(tree, query.pairs(), whole.pairs(), query.open());
      status = query.resume();
      ASSERT_TRUE(status);
      done += status.box_tests;
      ASSERT_LT(++calls, 100000u);
    }
    EXPECT_GT(calls, 3u);
    EXPECT_TRUE(query.open().empty());
    EXPECT_EQ(done, tests);
    ASSERT_EQ(query.pairs().size(), whole.pairs().size());
    for (std::size_t i = 0; i < whole.pairs().size(); ++i) {
      EXPECT_EQ(static_cast<const FeaturePair&>(query.pairs()[i]), whole.pairs()[i]);
      EXPECT_EQ(query.pairs()[i].distance, whole.pairs()[i].distance);
    }
  }
}

TEST(Proximity, is_the_same_for_any_number_of_workers) {
  Random random(32);
  const Moving m = test::wavy_sheet(40, 0.01, random);
  SurfaceTree tree(m.mesh);
  Workers workers(3);
  ProximityQuery one({.distance = 0.03}), three({.distance = 0.03});
  const SurfaceQueryStatus s = one.run(tree), t = three.run(tree, workers);
  EXPECT_EQ(s.box_tests, t.box_tests);
  EXPECT_EQ(s.candidates, t.candidates);
  ASSERT_EQ(one.pairs().size(), three.pairs().size());
  EXPECT_GT(one.pairs().size(), 1000u);
  for (std::size_t i = 0; i < one.pairs().size(); ++i) {
    EXPECT_EQ(static_cast<const FeaturePair&>(one.pairs()[i]), three.pairs()[i]);
    EXPECT_EQ(one.pairs()[i].point_a, three.pairs()[i].point_a);
  }
}

TEST(Proximity, keeps_nearest_features_once) {
  // A vertex above the common edge of two facets: found by both facets, kept once.
  Mesh mesh{{{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, 0.1}, {0.1, 0, 5}, {-0.1, 0, 5}},
            {{0, 2, 1}, {0, 1, 3}, {4, 5, 6}}};
  SurfaceTree tree(mesh);
  ProximityQuery all({.distance = 0.2}), once({.distance = 0.2, .nearest_features_once = true});
  ASSERT_TRUE(all.run(tree));
  ASSERT_TRUE(once.run(tree));
  EXPECT_EQ(once.pairs().size(), 1u);
  EXPECT_GE(all.pairs().size(), 4u);  // two facets, two edges from the tip against the common edge
  EXPECT_NEAR(once.pairs()[0].distance, 0.1, 1e-15);
  Random random(8);
  const Moving m = test::random_soup(14, 20, 3, random);
  SurfaceTree soup(m.mesh);
  ASSERT_TRUE(all.run(soup));
  ASSERT_TRUE(once.run(soup));
  // By vertices of nearest points: the same set, each once.
  const auto key = [&](const ProximityPair& p) {
    const auto taken = [&](PairKind kind, bool is_a, std::uint32_t i, const Barycentric& w) {
      Vertices v;
      const bool edge = kind == PairKind::edge_edge, vertex = !edge && is_a;
      for (std::size_t k = 0; k < 3; ++k)
        if (w[k] != 0) v.push_back(vertex ? i : edge ? soup.edges()[i][k] : soup.facets()[i][k]);
      return v;
    };
    return test::plain_pair(taken(p.kind, true, p.a, p.weights_a), taken(p.kind, false, p.b, p.weights_b), true);
  };
  std::set<PlainPair> expected, found;
  for (const ProximityPair& p : all.pairs()) expected.insert(key(p));
  for (const ProximityPair& p : once.pairs()) EXPECT_TRUE(found.insert(key(p)).second);
  EXPECT_EQ(expected, found);
}

TEST(Proximity, filters_leave_out_what_they_say_and_nothing_else) {
  Random random(41);
  const Moving m = test::wavy_sheet(5, 0.2, random);
  SurfaceTree tree(m.mesh);
  ASSERT_TRUE(tree.update(m.to));
  ProximityQuery all({.distance = 0.2});
  ASSERT_TRUE(all.run(tree));
  // Rings by a table of all distances along edges.
  const std::size_t n = m.mesh.positions.size();
  std::vector<std::vector<int>> hops(n, std::vector<int>(n, 1000));
  for (std::size_t v = 0; v < n; ++v) hops[v][v] = 0;
  for (const Vertices& e : test::plain_edges(m.mesh)) hops[e[0]][e[1]] = hops[e[1]][e[0]] = 1;
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) hops[i][j] = std::min(hops[i][j], hops[i][k] + hops[k][j]);
  const Components pieces = components_by_vertices(m.mesh);
  ASSERT_EQ(pieces.count, 2u);
  std::vector<std::uint32_t> piece(n);
  for (std::size_t f = 0; f < m.mesh.facets.size(); ++f)
    for (const std::uint32_t v : m.mesh.facets[f]) piece[v] = pieces.of_facet[f];
  const auto expect = [&](const PairFilter& filter, const auto& accepts, const char* what) {
    ProximityQuery query({.distance = 0.2, .filter = filter});
    ASSERT_TRUE(query.run(tree));
    std::vector<PlainPair> expected;
    for (const PlainPair& pair : plain_pairs(tree, tree, all.pairs()))
      if (accepts(pair)) expected.push_back(pair);
    const auto found = plain_pairs(tree, tree, query.pairs());
    EXPECT_TRUE(found == expected) << what << ": " << found.size() << " pairs, not " << expected.size();
    EXPECT_LT(expected.size(), all.pairs().size()) << what;
    EXPECT_GT(expected.size(), 0u) << what;
  };
  for (const int rings : {1, 2, 3})
    expect(
        {.rings = static_cast<std::uint32_t>(rings)},
        [&](const PlainPair& p) {
          for (const std::uint32_t v : p.a)
            for (const std::uint32_t w : p.b)
              if (hops[v][w] <= rings) return false;
          return true;
        },
        "rings");
  expect(
      {.same_component = true}, [&](const PlainPair& p) { return piece[p.a[0]] != piece[p.b[0]]; }, "components");
  expect(
      {.rest_distance = 0.0987},
      [&](const PlainPair& p) { return test::plain_distance(m.mesh.positions, p.a, p.b) > 0.0987L; }, "at rest");
  expect(
      {.accepts = [](const FeaturePair& pair) { return pair.a % 2 == 0; }},
      [&, kept =
              [&] {
                std::set<PlainPair> even;
                for (const ProximityPair& pair : all.pairs())
                  if (pair.a % 2 == 0) even.insert(test::plain_pair(tree, tree, pair));
                return even;
              }()](const PlainPair& p) { return kept.contains(p); },
      "predicate");
  // Facets of the first piece are of group 1 and meet group 2 alone.
  FacetMasks masks;
  for (const std::uint32_t of : pieces.of_facet)
    masks.category.push_back(of == 0 ? 1 : 2), masks.mask.push_back(of == 0 ? 2 : 3);
  expect(
      {.masks_a = masks}, [&](const PlainPair& p) { return piece[p.a[0]] != 0 || piece[p.b[0]] != 0; }, "masks");
}

/// The bits of all facets that have all of these vertices.
std::uint32_t bits_of(const Mesh& mesh, const std::vector<std::uint32_t>& bits, const test::Vertices& vertices) {
  std::uint32_t all = 0;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    if (std::all_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) {
          return std::find(mesh.facets[f].begin(), mesh.facets[f].end(), v) != mesh.facets[f].end();
        }))
      all |= bits[f];
  return all;
}

// Of groups that differ by side: often one of the two may meet the other, and not the other way round.
TEST(Proximity, masks_of_two_surfaces_ask_both_sides) {
  Random random(77);
  const auto some_bits = [&](std::size_t count) {
    std::vector<std::uint32_t> bits(count);
    for (std::uint32_t& b : bits) b = 1u << (random.next() % 3);
    return bits;
  };
  std::size_t one_way = 0, other_way = 0, kept = 0;
  for (int round = 0; round < 6; ++round) {
    const Mesh a = test::uv_sphere(6, 5, 1.0), b = test::translated(test::icosphere(1, 0.9), {0.3, 0.2, 0.1});
    const SurfaceTree tree_a(a), tree_b(b);
    PairFilter filter{.masks_a = {some_bits(a.facets.size()), some_bits(a.facets.size())},
                      .masks_b = {some_bits(b.facets.size()), some_bits(b.facets.size())}};
    if (round == 4) filter.masks_a.of.clear(), filter.masks_b.with.clear();
    if (round == 5) filter.masks_a.with.clear(), filter.masks_b.of.clear();
    const auto or_ones = [](const std::vector<std::uint32_t>& bits, std::size_t count) {
      return bits.empty() ? std::vector<std::uint32_t>(count, ~0u) : bits;
    };
    const auto of_a = or_ones(filter.masks_a.of, a.facets.size()),
               with_a = or_ones(filter.masks_a.with, a.facets.size());
    const auto of_b = or_ones(filter.masks_b.of, b.facets.size()),
               with_b = or_ones(filter.masks_b.with, b.facets.size());
    ProximityQuery all({.distance = 0.2}), masked({.distance = 0.2, .filter = filter});
    SurfaceCrossingQuery all_crossings, masked_crossings({.filter = filter});
    ASSERT_TRUE(all.run(tree_a, tree_b) && masked.run(tree_a, tree_b));
    ASSERT_TRUE(all_crossings.run(tree_a, tree_b) && masked_crossings.run(tree_a, tree_b));
    const auto meets = [&](const test::Vertices& p, const test::Vertices& q) {
      const bool there = (bits_of(a, of_a, p) & bits_of(b, with_b, q)) != 0;
      const bool back = (bits_of(b, of_b, q) & bits_of(a, with_a, p)) != 0;
      one_way += there && !back, other_way += back && !there, kept += there && back;
      return there && back;
    };
    const auto expected = [&](const auto& pairs) {
      std::vector<PlainPair> left;
      for (const PlainPair& pair : plain_pairs(tree_a, tree_b, pairs))
        if (meets(pair.a, pair.b)) left.push_back(pair);
      return left;
    };
    EXPECT_EQ(plain_pairs(tree_a, tree_b, masked.pairs()), expected(all.pairs()));
    EXPECT_EQ(plain_pairs(tree_a, tree_b, masked_crossings.pairs()), expected(all_crossings.pairs()));
  }
  EXPECT_GT(one_way, 100u);
  EXPECT_GT(other_way, 100u);
  EXPECT_GT(kept, 100u);
}

// Boxes of the deeper tree are opened alone at first, and what is left open is counted on its own levels.
TEST(SurfaceCrossings, of_surfaces_of_unequal_depth_are_complete_at_every_interruption) {
  const Mesh large = test::uv_sphere(40, 40, 1.0);
  std::size_t missing = 0;
  for (const Mesh& few : {test::translated(test::icosphere(0, 0.7), {0.9, 0, 0}),
                          test::translated(test::uv_sphere(7, 6, 0.5), {0, 0.9, 0.1})}) {
    const SurfaceTree deep(large), shallow(few);
    for (const bool swapped : {false, true}) {
      const SurfaceTree &a = swapped ? shallow : deep, &b = swapped ? deep : shallow;
      const Mesh &mesh_a = swapped ? few : large, &mesh_b = swapped ? large : few;
      std::vector<FeaturePair> all;
      const auto corners = [](const Mesh& mesh, std::uint32_t f) {
        const Facet& facet = mesh.facets[f];
        return Triangle{mesh.positions[facet[0]], mesh.positions[facet[1]], mesh.positions[facet[2]]};
      };
      for (std::uint32_t f = 0; f < mesh_a.facets.size(); ++f)
        for (std::uint32_t g = 0; g < mesh_b.facets.size(); ++g)
          if (intersect(corners(mesh_a, f), corners(mesh_b, g))) all.push_back({PairKind::facet_facet, f, g});
      ASSERT_GT(all.size(), 20u);
      SurfaceCrossingQuery query({.budget = 64});
      SurfaceQueryStatus status = query.run(a, b);
      for (; status && !status.finished; status = query.resume()) {
        const std::set<FeaturePair> found(query.pairs().begin(), query.pairs().end());
        for (const OpenFacets& open : query.open()) {
          ASSERT_FALSE(open.a.empty());
          ASSERT_FALSE(open.b.empty());
        }
        for (const FeaturePair& pair : all) {
          if (found.contains(pair)) continue;
          ++missing;
          const auto has = [](std::span<const std::uint32_t> facets, std::uint32_t facet) {
            return std::find(facets.begin(), facets.end(), facet) != facets.end();
          };
          ASSERT_TRUE(std::any_of(query.open().begin(), query.open().end(),
                                  [&](const OpenFacets& open) { return has(open.a, pair.a) && has(open.b, pair.b); }));
        }
      }
      ASSERT_TRUE(status);
      EXPECT_EQ(std::vector<FeaturePair>(query.pairs().begin(), query.pairs().end()), all);
    }
  }
  EXPECT_GT(missing, 1000u);
}

TEST(Proximity, safe_distances_keep_surfaces_apart) {
  Random random(51);
  const Mesh a = test::icosphere(2), b = test::translated(test::icosphere(2), {2.05, 0, 0});
  const Mesh both = test::joined(a, b);
  SurfaceTree tree(both);
  ProximityQuery query({.distance = 0.4});
  ASSERT_TRUE(query.run(tree));
  std::vector<double> safe(both.positions.size());
  query.safe_distances(safe);
  EXPECT_LT(*std::min_element(safe.begin(), safe.end()), 0.05);
  EXPECT_LE(*std::max_element(safe.begin(), safe.end()), 0.2);
  for (int round = 0; round < 50; ++round) {
    std::vector<Vec3> moved = both.positions;
    for (std::size_t v = 0; v < moved.size(); ++v)
      // Mostly towards the other one.
      moved[v] += normalized(Vec3{moved[v].x < 1 ? 1.0 : -1.0, random.uniform(-1, 1), random.uniform(-1, 1)}) *
                  safe[v] * (1 - 1e-9);
    ASSERT_TRUE(tree.update(moved));
    SurfaceCrossingQuery crossings({.filter = {.same_component = true}});
    ASSERT_TRUE(crossings.run(tree));
    EXPECT_TRUE(crossings.pairs().empty());
  }
}

// Far from the origin computed distances are off by their last digits, and may be longer than they are.
TEST(Proximity, safe_distances_are_not_more_than_half_of_any_distance_far_from_the_origin) {
  Random random(52);
  for (int round = 0; round < 40; ++round) {
    const double far = std::pow(10.0, round % 10), reach = 1 + round % 4;
    Mesh mesh = test::random_soup(14, 12, static_cast<int>(reach), random).mesh;
    for (Vec3& p : mesh.positions)
      p = p + test::random_point(random, 0.1) + Vec3{far, -0.7 * far, round % 3 == 0 ? far / 3 : 0.0};
    const SurfaceTree tree(mesh);
    ProximityQuery query({.distance = 0.5});
    ASSERT_TRUE(query.run(tree).finished);
    std::vector<double> safe(mesh.positions.size());
    query.safe_distances(safe);
    test::pairs_with_itself(mesh, [&](const Vertices& a, const Vertices& b) {
      const long double apart = test::plain_distance(mesh.positions, a, b);
      for (const Vertices& vertices : {a, b})
        for (const std::uint32_t v : vertices) EXPECT_LE(2 * static_cast<long double>(safe[v]), apart + 1e-18L * far);
      return false;
    });
  }
  std::vector<double> nothing(3, 1.0);
  ProximityQuery({.distance = 0.5}).safe_distances(nothing);
  EXPECT_EQ(nothing, std::vector<double>(3, 0.0));
}

// They are of the frame that was asked about, wherever the surface has gone since.
TEST(Proximity, safe_distances_stay_when_the_surface_moves) {
  Random random(53);
  Mesh mesh = test::random_soup(14, 12, 2, random).mesh;
  for (Vec3& p : mesh.positions) p = p + test::random_point(random, 0.1);
  SurfaceTree tree(mesh);
  ProximityQuery query({.distance = 0.5});
  ASSERT_TRUE(query.run(tree).finished);
  ASSERT_FALSE(query.pairs().empty());
  std::vector<double> before(mesh.positions.size()), after(before);
  query.safe_distances(before);
  ASSERT_TRUE(std::any_of(before.begin(), before.end(), [](double d) { return d > 0; }));
  std::vector<Vec3> far;
  for (const Vec3& p : mesh.positions) far.push_back(p * 1e9);
  ASSERT_TRUE(tree.update(far));
  query.safe_distances(after);
  EXPECT_EQ(before, after);
}

TEST(SurfaceCrossings, are_those_of_all_facets_against_all) {
  Random random(61);
  std::size_t total = 0;
  for (int round = 0; round < 60; ++round) {
    const Moving m =
        round % 2 == 0 ? test::wavy_sheet(5, 0.2, random) : test::random_soup(15, 30, 1 + round % 5, random);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.to));
    SurfaceCrossingQuery query;
    ASSERT_TRUE(query.run(tree).finished);
    std::vector<FeaturePair> expected;
    const auto corners = [&](const Facet& f) { return Triangle{m.to[f[0]], m.to[f[1]], m.to[f[2]]}; };
    for (std::uint32_t f = 0; f < m.mesh.facets.size(); ++f)
      for (std::uint32_t g = f + 1; g < m.mesh.facets.size(); ++g) {
        const Facet &x = m.mesh.facets[f], &y = m.mesh.facets[g];
        const bool share = std::any_of(x.begin(), x.end(),
                                       [&](std::uint32_t v) { return std::find(y.begin(), y.end(), v) != y.end(); });
        if (!share && intersect(corners(x), corners(y))) expected.push_back({PairKind::facet_facet, f, g});
      }
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), query.pairs().begin(), query.pairs().end()));
    total += expected.size();
    SurfaceCrossingQuery bit_by_bit({.budget = 640});
    SurfaceQueryStatus status = bit_by_bit.run(tree);
    for (int calls = 0; status && !status.finished && calls < 10000; ++calls) status = bit_by_bit.resume();
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), bit_by_bit.pairs().begin(), bit_by_bit.pairs().end()));
  }
  EXPECT_GT(total, 1000u);
}

TEST(SurfaceQueries, allocate_nothing_once_they_are_warm) {
  Random random(71);
  const Moving m = test::wavy_sheet(20, 0.05, random);
  SurfaceTree tree(m.mesh);
  ProximityQuery near({.distance = 0.02});
  SurfaceCrossingQuery crossings;
  bool good = true;
  const auto ask = [&] {
    good = good && tree.update(m.to) && near.run(tree) && crossings.run(tree);
    good = good && tree.update(m.from) && near.run(tree) && crossings.run(tree);
  };
  ask();
  ask();
  const std::size_t before = test::allocations;
  ask();
  const std::size_t after = test::allocations;
  EXPECT_TRUE(good);
  EXPECT_EQ(after, before);
}

}  // namespace
}  // namespace morula
