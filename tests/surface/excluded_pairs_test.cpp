// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs that queries of one surface leave out, as neighbors or as near at rest, against all pairs and a judge that
// shares no code with the library: hops along edges, and distances in long double.
#include "surface/pairs/excluded_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <string>
#include <support/allocations.hpp>
#include <thread>
#include <type_traits>

#include "surface/pairs/feature_filter.hpp"
#include "surfaces.hpp"

namespace morula {
namespace {

using detail::ExcludedPairs;
using detail::ExclusionRule;
using detail::Features;
using test::Moving;
using test::plain_pairs;
using test::PlainPair;
using test::Vertices;

constexpr std::int64_t unreached = std::int64_t{1} << 40;

class Judge {
 public:
  explicit Judge(const Mesh& mesh) : mesh_(mesh) {
    for (const Vertices& e : test::plain_edges(mesh)) next_[e[0]].push_back(e[1]), next_[e[1]].push_back(e[0]);
  }
  std::int64_t hops(const PlainPair& pair) {
    std::int64_t least = unreached;
    for (const std::uint32_t v : pair.a)
      for (const std::uint32_t w : pair.b) least = std::min(least, hops_from(v)[w]);
    return least;
  }
  /// At rest. are_facets: of two facets. Facets may have fewer vertices than three.
  long double distance(PlainPair pair, bool are_facets) const {
    if (are_facets || pair.b.size() == 1) pair.a.resize(3, pair.a.back());
    if (are_facets || pair.a.size() == 1) pair.b.resize(3, pair.b.back());
    if (!are_facets) return test::plain_distance(mesh_.positions, pair.a, pair.b);
    const auto triangle = [&](const Vertices& f) {
      return Triangle{mesh_.positions[f[0]], mesh_.positions[f[1]], mesh_.positions[f[2]]};
    };
    if (intersect(triangle(pair.a), triangle(pair.b))) return 0;
    long double least = std::numeric_limits<long double>::infinity();
    const auto take = [&](const Vertices& a, const Vertices& b) {
      least = std::min(least, test::plain_distance(mesh_.positions, a, b));
    };
    for (std::size_t i = 0; i < 3; ++i) {
      take({pair.a[i]}, pair.b), take({pair.b[i]}, pair.a);
      for (std::size_t j = 0; j < 3; ++j) take({pair.a[i], pair.a[(i + 1) % 3]}, {pair.b[j], pair.b[(j + 1) % 3]});
    }
    return least;
  }

 private:
  const std::vector<std::int64_t>& hops_from(std::uint32_t v) {
    std::vector<std::int64_t>& hops = hops_[v];
    if (!hops.empty()) return hops;
    hops.assign(mesh_.positions.size(), unreached);
    hops[v] = 0;
    std::vector<std::uint32_t> queue{v};
    for (std::size_t i = 0; i < queue.size(); ++i)
      for (const std::uint32_t w : next_[queue[i]])
        if (hops[w] == unreached) hops[w] = hops[queue[i]] + 1, queue.push_back(w);
    return hops;
  }

  const Mesh& mesh_;
  std::map<std::uint32_t, std::vector<std::uint32_t>> next_;
  std::map<std::uint32_t, std::vector<std::int64_t>> hops_;
};

struct Counts {
  std::size_t left_out = 0, kept = 0;
};

/// `found` are the pairs of `all` that the filter keeps; of those within rounding of its distance, any.
void expect_kept(const SurfaceTree& tree, Judge& judge, const PairFilter& filter, const std::vector<PlainPair>& all,
                 const std::vector<PlainPair>& found, bool are_facets, double scale, Counts& counts) {
  std::size_t next = 0;
  for (const PlainPair& pair : all) {
    const bool is_found = next < found.size() && found[next] == pair;
    next += is_found ? 1 : 0;
    const long double distance = filter.rest_distance > 0 ? judge.distance(pair, are_facets) : 1e30L;
    if (filter.rings > 0 && judge.hops(pair) <= std::int64_t{filter.rings}) {
      ASSERT_FALSE(is_found) << "neighbors";
    } else if (distance < filter.rest_distance - 1e-13L * scale) {
      ASSERT_FALSE(is_found) << "near at rest: " << static_cast<double>(distance);
    } else if (distance > filter.rest_distance + 1e-13L * scale || filter.rest_distance == 0) {
      ASSERT_TRUE(is_found) << "left out";
    }
    (is_found ? counts.kept : counts.left_out) += 1;
  }
  ASSERT_EQ(next, found.size()) << "found without being there, of " << tree.facets().size() << " facets";
}

std::vector<PairFilter> filters_for(double size) {
  return {{.rings = 1},
          {.rings = 2},
          {.rings = 5},
          {.rings = 4000000000u},
          {.rest_distance = 1e-9 * size},
          {.rest_distance = 0.0987 * size},
          {.rest_distance = 0.25 * size},
          {.rest_distance = 0.5 * size},
          {.rest_distance = 1e9 * size},
          {.rings = 1, .rest_distance = 0.2 * size}};
}

struct RestBody {
  std::string name;
  Mesh mesh;
  std::vector<Vec3> from, to;  // a step after rest
};

RestBody scaled(RestBody body, double by, const Vec3& shift) {
  for (std::vector<Vec3>* points : {&body.mesh.positions, &body.from, &body.to})
    for (Vec3& p : *points) p = p * by + shift;
  return body;
}

/// Degenerate, aligned, non-manifold, of several pieces, far away, small, and of one facet.
std::vector<RestBody> bodies() {
  Random random(2026);
  std::vector<RestBody> found;
  const auto add = [&](const std::string& name, Moving m) {
    found.push_back({name, std::move(m.mesh), std::move(m.from), std::move(m.to)});
  };
  add("soup", test::random_soup(30, 40, 2, random));
  add("dense soup", test::random_soup(12, 60, 1, random));
  add("sheets", test::wavy_sheet(5, 0.2, random));
  RestBody tube = found.back();
  // What lies on a grid, with facets that are there twice, turned round, and with a repeated vertex.
  for (std::size_t f = 0; f < tube.mesh.facets.size(); f += 7) {
    const Facet facet = tube.mesh.facets[f];
    tube.mesh.facets.push_back({facet[1], facet[0], facet[2]});
    tube.mesh.facets.push_back({facet[0], facet[0], facet[1]});
  }
  tube.name = "repeated facets";
  found.push_back(tube);
  found.push_back(scaled(found[0], 1, {3e6, -5e6, 7e6}));
  found.back().name = "far soup";
  found.push_back(scaled(found[2], 0x1p-90, {}));
  found.back().name = "small sheets";
  RestBody one{"one facet", {}, {}, {}};
  one.mesh.positions = one.from = one.to = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.mesh.facets = {{0, 1, 2}};
  found.push_back(one);
  return found;
}

template <class Query, class Options>
void expect_filtered(const RestBody& body, const SurfaceTree& tree, Judge& judge, Options options, double size,
                     Counts& counts) {
  Query plain(options);
  ASSERT_TRUE(plain.run(tree).finished);
  const auto all = plain_pairs(tree, tree, plain.pairs());
  double scale = size;
  for (const Vec3& p : body.mesh.positions) scale = std::max(scale, max_norm(p));
  // One query is asked with one filter after the other, as well as a new one.
  Query again(options);
  for (const PairFilter& filter : filters_for(size)) {
    options.filter = filter;
    again.set_options(options);
    Workers two(2);
    ASSERT_TRUE(again.run(tree, two).finished);
    const auto found = plain_pairs(tree, tree, again.pairs());
    expect_kept(tree, judge, filter, all, found, std::is_same_v<Query, SurfaceCrossingQuery>, scale, counts);
    if (testing::Test::HasFatalFailure()) {
      ADD_FAILURE() << body.name << ", rings " << filter.rings << ", rest_distance " << filter.rest_distance;
      return;
    }
    options.budget = 640;
    Query bit_by_bit(options);
    SurfaceQueryStatus status = bit_by_bit.run(tree);
    for (int calls = 0; status && !status.finished && calls < 100000; ++calls) status = bit_by_bit.resume();
    EXPECT_EQ(plain_pairs(tree, tree, bit_by_bit.pairs()), found) << body.name;
    options.budget = {};
  }
}

TEST(ExcludedPairs, are_the_neighbors_and_what_is_near_at_rest) {
  Counts crossings, near, swept;
  for (const RestBody& body : bodies()) {
    const Box box = bounding_box(body.mesh);
    const double size = max_norm(box.upper - box.lower);
    SurfaceTree tree(body.mesh);
    Judge judge(body.mesh);
    ASSERT_TRUE(tree.update(body.to));
    expect_filtered<SurfaceCrossingQuery>(body, tree, judge, SurfaceCrossingOptions{}, size, crossings);
    expect_filtered<ProximityQuery>(body, tree, judge, ProximityOptions{.distance = 0.1 * size}, size, near);
    ASSERT_TRUE(tree.update(body.from, body.to));
    expect_filtered<SweptQuery>(body, tree, judge, SweptOptions{}, size, swept);
  }
  for (const Counts& counts : {crossings, near, swept}) {
    EXPECT_GT(counts.left_out, 1000u);
    EXPECT_GT(counts.kept, 400u);
  }
}

// Where a unit is all that coordinates can resolve, a computed distance is off by a unit: boxes and vertices have to
// decide as the distance of every single pair does.
TEST(ExcludedPairs, are_those_that_their_own_distance_excludes_however_coarse_coordinates_are) {
  Random random(4);
  std::size_t excluded = 0, kept = 0;
  for (int round = 0; round < 12; ++round) {
    Mesh mesh = test::random_soup(40, 60, 1 + round % 4, random).mesh;
    const double far = round % 4 == 0 ? 0 : std::ldexp(1.0, 51 + round % 2);
    for (Vec3& p : mesh.positions) p = p + Vec3{far, far, -far};
    const SurfaceTree tree(mesh);
    const detail::SurfaceTreeState& s = detail::state_of(tree);
    for (const double r : {0.5, 1.0, 1.5, 2.0, 2.5, 3.5}) {
      const detail::RestTest test(r, detail::ExclusionTest(s, {0, r, Features::all}).rounding());
      const auto check = [&](PairKind kind, std::uint32_t x, std::uint32_t y) {
        const bool is_near = test.is_near(s, {kind, x, y});
        (is_near ? excluded : kept) += 1;
        ASSERT_EQ(is_near, detail::are_within_at_rest(s, {kind, x, y}, r)) << far << ' ' << r;
      };
      for (std::uint32_t f = 0; f < mesh.facet_count(); ++f) {
        for (std::uint32_t g = 0; g < f; ++g) check(PairKind::facet_facet, g, f);
        for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) check(PairKind::vertex_facet, v, f);
      }
    }
  }
  EXPECT_GT(excluded, 10000u);
  EXPECT_GT(kept, 10000u);
}

template <class Query, class Options>
std::vector<FeaturePair> found_by_a_new_query(const SurfaceTree& tree, const Options& options) {
  Query query(options);
  EXPECT_TRUE(query.run(tree).finished);
  return {query.pairs().begin(), query.pairs().end()};
}

// More filters than a surface keeps tables for, in turn, and surfaces that take the place of others.
TEST(ExcludedPairs, follow_the_filter_and_the_surface) {
  Random random(7);
  const Moving one = test::wavy_sheet(5, 0.2, random), other = test::random_soup(30, 40, 2, random);
  SurfaceTree tree(one.mesh);
  ProximityQuery query({.distance = 0.2});
  std::vector<std::size_t> sizes;
  for (int round = 0; round < 3; ++round) {
    const Moving& m = round % 2 == 0 ? one : other;
    tree = SurfaceTree(m.mesh);
    ASSERT_TRUE(tree.update(m.to));
    for (int repeat = 0; repeat < 2; ++repeat)
      for (const PairFilter& filter : filters_for(1)) {
        query.set_options({.distance = 0.2, .filter = filter});
        ASSERT_TRUE(query.run(tree).finished);
        SurfaceTree apart(m.mesh);
        ASSERT_TRUE(apart.update(m.to));
        const auto expected =
            found_by_a_new_query<ProximityQuery>(apart, ProximityOptions{.distance = 0.2, .filter = filter});
        ASSERT_TRUE(std::equal(expected.begin(), expected.end(), query.pairs().begin(), query.pairs().end(),
                               [](const FeaturePair& p, const FeaturePair& q) { return p == q; }));
        sizes.push_back(expected.size());
      }
  }
  std::sort(sizes.begin(), sizes.end());
  EXPECT_GT(std::unique(sizes.begin(), sizes.end()) - sizes.begin(), 8);
}

// The same pairs, by their vertices, however facets are numbered.
TEST(ExcludedPairs, do_not_depend_on_the_order_of_facets) {
  Random random(8);
  const Moving m = test::wavy_sheet(6, 0.2, random);
  Mesh turned = m.mesh;
  std::reverse(turned.facets.begin(), turned.facets.end());
  SurfaceTree tree(m.mesh), turned_tree(turned);
  ASSERT_TRUE(tree.update(m.to) && turned_tree.update(m.to));
  std::size_t pairs = 0;
  for (const PairFilter& filter : filters_for(1)) {
    ProximityQuery query({.distance = 0.2, .filter = filter}), turned_query(query.options());
    SurfaceCrossingQuery crossings({.filter = filter}), turned_crossings(crossings.options());
    ASSERT_TRUE(query.run(tree) && turned_query.run(turned_tree));
    ASSERT_TRUE(crossings.run(tree) && turned_crossings.run(turned_tree));
    EXPECT_EQ(plain_pairs(tree, tree, query.pairs()), plain_pairs(turned_tree, turned_tree, turned_query.pairs()));
    EXPECT_EQ(plain_pairs(tree, tree, crossings.pairs()),
              plain_pairs(turned_tree, turned_tree, turned_crossings.pairs()));
    pairs += query.pairs().size() + crossings.pairs().size();
  }
  EXPECT_GT(pairs, 1000u);
}

/// n by n squares, rolled up so that the sheet goes through itself.
Moving rolled_sheet(std::uint32_t n) {
  Moving m;
  for (std::uint32_t y = 0; y < n; ++y)
    for (std::uint32_t x = 0; x < n; ++x) {
      const double u = static_cast<double>(x) / n, w = static_cast<double>(y) / n;
      m.mesh.positions.push_back({u, w, 0});
      const auto [sine, cosine] = sin_cos(7.5 * u);
      m.to.push_back({sine, cosine, w + 0.3 * u});
    }
  for (std::uint32_t y = 0; y + 1 < n; ++y)
    for (std::uint32_t x = 0; x + 1 < n; ++x) {
      const std::uint32_t v = y * n + x;
      m.mesh.facets.push_back({v, v + 1, v + n});
      m.mesh.facets.push_back({v + 1, v + n + 1, v + n});
    }
  m.from = m.mesh.positions;
  return m;
}

TEST(ExcludedPairs, are_found_one_by_one_where_a_table_would_be_too_large) {
  Counts counts;
  {
    const Moving m = rolled_sheet(70);
    SurfaceTree tree(m.mesh);
    ASSERT_TRUE(tree.update(m.to));
    const PairFilter filter{.rings = 57};
    const ExcludedPairs table(detail::state_of(tree), {filter.rings, 0, Features::facets}, serial_workers());
    table.make_table(serial_workers());
    ASSERT_FALSE(table.is_whole());
    SurfaceCrossingQuery all, query({.filter = filter});
    ASSERT_TRUE(all.run(tree) && query.run(tree));
    Judge judge(m.mesh);
    expect_kept(tree, judge, filter, plain_pairs(tree, tree, all.pairs()), plain_pairs(tree, tree, query.pairs()), true,
                1, counts);
  }
  EXPECT_GT(counts.left_out, 10u);
  EXPECT_GT(counts.kept, 10u);
  counts = {};
  Random random(5);
  Mesh mesh;
  for (std::uint32_t f = 0; f < 1000; ++f) {
    const auto point = [&] { return Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; };
    const Vec3 middle = point();
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(middle + point() * 1.2);
    mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  SurfaceTree tree(mesh);
  std::vector<Vec3> moved;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    moved.push_back(mesh.positions[v] + Vec3{0, 0, v % 2 == 0 ? 1.0 : -1.0});
  ASSERT_TRUE(tree.update(moved));
  const PairFilter filter{.rest_distance = 0.3234};
  ProximityQuery all({.distance = 0.004}), query({.distance = 0.004, .filter = filter});
  ASSERT_TRUE(all.run(tree) && query.run(tree));
  Judge judge(mesh);
  expect_kept(tree, judge, filter, plain_pairs(tree, tree, all.pairs()), plain_pairs(tree, tree, query.pairs()), false,
              1, counts);
  EXPECT_GT(counts.left_out, 100u);
  EXPECT_GT(counts.kept, 100u);
}

TEST(ExcludedPairs, take_no_more_than_the_memory_that_is_allowed_for_them) {
  const Mesh limb = sample_body("limb", 24);
  const SurfaceTree tree(limb);
  std::size_t whole = 0;
  for (const Features features : {Features::facets, Features::all}) {
    for (const std::uint32_t rings : {1u, 4u, 12u, 1000u}) {
      const ExcludedPairs table(detail::state_of(tree), {rings, 0, features}, serial_workers());
      table.make_table(serial_workers());
      // The rows, the blocks of vertices, and a pointer per block.
      EXPECT_LE(table.bytes(), (ExcludedPairs::most_bytes_per_facet + 16) * limb.facet_count() + 10000);
      EXPECT_EQ(table.rest_bytes(), 0u);
      whole += table.is_whole() ? 1 : 0;
      // Rings that reach everything take a row of one entry per block.
      if (rings == 1000) {
        EXPECT_LT(table.bytes(), 40 * limb.facet_count());
      }
    }
    const ExcludedPairs near(detail::state_of(tree), {0, 0.1, features}, serial_workers());
    EXPECT_LT(near.rest_bytes(), 130 * limb.facet_count());
    EXPECT_GT(near.rest_bytes(), 30 * limb.facet_count());
    EXPECT_LT(near.bytes(), 1000u);
  }
  EXPECT_GE(whole, 6u);
}

TEST(ExcludedPairs, cost_no_allocation_in_later_calls) {
  Random random(71);
  const Moving m = test::wavy_sheet(12, 0.05, random);
  SurfaceTree tree(m.mesh);
  const PairFilter filter{.rings = 2, .rest_distance = 0.05};
  ProximityQuery near({.distance = 0.05, .filter = filter});
  SurfaceCrossingQuery crossings({.filter = filter});
  bool good = true;
  const auto ask = [&] { good = good && tree.update(m.to) && near.run(tree) && crossings.run(tree); };
  EXPECT_EQ(test::allocations_once_warm(ask), 0u);
  EXPECT_TRUE(good);
}

TEST(ExcludedPairs, serve_queries_of_several_threads) {
  Random random(9);
  const Moving m = test::wavy_sheet(6, 0.2, random);
  SurfaceTree tree(m.mesh);
  ASSERT_TRUE(tree.update(m.to));
  const std::vector<PairFilter> filters = filters_for(1);
  std::vector<std::vector<FeaturePair>> found(2 * filters.size());
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < found.size(); ++i)
    threads.emplace_back([&, i] {
      SurfaceCrossingQuery query({.filter = filters[i % filters.size()]});
      for (int round = 0; round < 3; ++round) EXPECT_TRUE(query.run(tree));
      found[i].assign(query.pairs().begin(), query.pairs().end());
    });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_EQ(found[i], found_by_a_new_query<SurfaceCrossingQuery>(
                            tree, SurfaceCrossingOptions{.filter = filters[i % filters.size()]}));
}

}  // namespace
}  // namespace morula
