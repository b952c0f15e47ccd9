// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vector kernels of updates against their plain twins, bit for bit.
#include "update/points/kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <numeric>
#include <span>
#include <vector>

#include "random_points.hpp"
#include "simd/processors.hpp"
#include "update/points/narrow.hpp"
#include "update/points/rounding.hpp"

namespace morula {
using namespace detail;
namespace {

using test::random_points;

// A list and two runs of the points.
constexpr PointRun some_runs[]{{3, 19}, {100, 164}};

TEST(Kernels, all_that_this_processor_runs_agree_bit_for_bit) {
  ASSERT_GE(all_kernels().size(), 1u);
  for (const double magnitude : {1e-25, 1e-3, 1.0, 1e17}) {
    const std::vector<LocalPoint> points = random_points(400, magnitude, 3);
    Random random(8);
    std::vector<std::uint32_t> index(240);
    for (std::uint32_t& i : index) i = static_cast<std::uint32_t>(random.uniform(0, 400));
    std::vector<std::uint32_t> measured = index;
    for (const PointRun& run : some_runs)
      for (std::uint32_t i = run.begin; i < run.end; ++i) measured.push_back(i);
    for (std::size_t count = 1; count <= most_centers; ++count) {
      std::vector<Vec3f> centers;
      for (std::size_t k = 0; k < count; ++k) centers.push_back({points[k].x, points[k + 7].y, points[k + 9].z});
      std::array<float, most_centers> expected{};
      for (std::size_t k = 0; k < count; ++k)
        for (const std::uint32_t i : measured)
          expected[k] = std::max(expected[k], squared_distance(centers[k], {points[i].x, points[i].y, points[i].z}));
      for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
        const Kernels& kernel = all_kernels()[kind];
        std::array<float, most_centers> found{};
        kernel.farthest(points.data(), std::span(some_runs), index, centers, found.data());
        for (std::size_t k = 0; k < count; ++k)
          EXPECT_EQ(std::bit_cast<std::uint32_t>(found[k]), std::bit_cast<std::uint32_t>(expected[k]))
              << kind_name(kind) << ", " << count << " centers";
      }
    }
  }
}

// By groups, and of those alone that had enough.
TEST(Kernels, groups_of_points_agree_bit_for_bit) {
  for (const double magnitude : {1e-25, 1e-3, 1.0, 1e17}) {
    const std::vector<LocalPoint> points = random_points(400, magnitude, 4);
    Random random(9);
    std::vector<std::uint32_t> index(5 * points_per_group), measured;
    for (std::uint32_t& i : index) i = static_cast<std::uint32_t>(random.uniform(0, 400));
    for (const PointRun& run : some_runs)
      for (std::uint32_t i = run.begin; i < run.end; ++i) measured.push_back(i);
    measured.insert(measured.end(), index.begin(), index.end());
    const std::size_t count = measured.size() / points_per_group;
    const Vec3f center{points[5].x, points[6].y, points[7].z};
    std::vector<float> expected(count, 0.0f), before(count);
    for (std::size_t i = 0; i < measured.size(); ++i) {
      const LocalPoint& p = points[measured[i]];
      float& most = expected[i / points_per_group];
      most = std::max(most, squared_distance(center, {p.x, p.y, p.z}));
    }
    for (std::size_t g = 0; g < count; ++g) before[g] = static_cast<float>(g % 3);
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
      const Kernels& kernel = all_kernels()[kind];
      std::vector<float> found(count);
      kernel.farthest_of_groups(points.data(), std::span(some_runs), index, center, found.data());
      EXPECT_EQ(found, expected) << kind_name(kind);
      for (const float least : {0.0f, 1.0f, 2.0f, 3.0f}) {
        float most = 0;
        for (std::size_t g = 0; g < count; ++g)
          if (before[g] >= least) most = std::max(most, expected[g]);
        EXPECT_EQ(kernel.farthest_of_some(points.data(), std::span(some_runs), index, center, before.data(), least),
                  most)
            << kind_name(kind) << ", " << least;
      }
    }
  }
}

// The farthest point may sit in any lane of any group, of the list or of a run.
TEST(Kernels, every_place_in_the_list_counts) {
  std::vector<LocalPoint> points = random_points(32, 1.0, 2);
  std::vector<std::uint32_t> index(16);
  std::iota(index.begin(), index.end(), 0u);
  const PointRun run{16, 32};
  const Vec3f center{0, 0, 0};
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
      const Kernels& kernel = all_kernels()[kind];
      const LocalPoint kept = points[i];
      points[i] = {0, i % 2 == 0 ? -10.0f : 10.0f, 0, 0};
      float squared = 0;
      kernel.farthest(points.data(), std::span(&run, 1), index, std::span(&center, 1), &squared);
      EXPECT_EQ(squared, 100.0f) << "point " << i << ", " << kind_name(kind);
      points[i] = kept;
    }
}

float farthest_of(const std::vector<LocalPoint>& points, std::span<const std::uint32_t> index, const Vec3f& center) {
  float squared = 0;
  all_kernels().front().farthest(points.data(), {}, index, std::span(&center, 1), &squared);
  return std::sqrt(squared);
}

TEST(Kernels, a_pull_never_ends_farther_out_and_agrees_bit_for_bit) {
  int nearer = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const std::vector<LocalPoint> points = random_points(64, 1.0, seed);
    Random random(seed);
    std::vector<std::uint32_t> core(core_size);
    for (std::uint32_t& i : core) i = static_cast<std::uint32_t>(random.uniform(0, seed % 2 == 0 ? 64 : 5));
    const Vec3f center{points[1].x, points[2].y, points[3].z};
    const float rest_radius = static_cast<float>(random.uniform(0.3, 1.2)), enough = 1.01f * rest_radius;
    const Pull pull{core.data(), enough * enough, rest_radius};
    const Vec3f expected = all_kernels().front().pull(points.data(), pull, center);
    const float before = farthest_of(points, core, center), after = farthest_of(points, core, expected);
    EXPECT_LE(after, before);
    if (before <= enough) {
      EXPECT_EQ(expected, center) << "close enough, so it stays";
    }
    nearer += after < before;
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind)
      EXPECT_EQ(all_kernels()[kind].pull(points.data(), pull, center), expected) << kind_name(kind);
  }
  EXPECT_GT(nearer, 200);
}

TEST(Kernels, many_pulls_at_once_are_what_each_is_alone) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const std::vector<LocalPoint> points = random_points(64, seed % 3 == 0 ? 1e-3 : 1.0, seed);
    Random random(seed);
    // Every core names some points, at most core_count, and goes on with the first.
    const auto core_count = static_cast<std::size_t>(random.uniform(1, core_size + 1));
    std::vector<std::uint32_t> cores(core_size * nodes_at_once);
    std::vector<float> rest_radii(nodes_at_once);
    std::vector<LocalPoint> centers(nodes_at_once);
    for (std::size_t k = 0; k < nodes_at_once; ++k) {
      for (std::size_t i = 0; i < core_size; ++i)
        cores[nodes_at_once * i + k] = i < core_count ? static_cast<std::uint32_t>(random.uniform(0, 64)) : cores[k];
      rest_radii[k] = static_cast<float>(random.uniform(k % 4 == 0 ? 1.0 : 0.0, 1.2));
      centers[k] = k == 5 ? points[cores[k]] : points[k];
    }
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
      std::vector<LocalPoint> moved = centers;
      all_kernels()[kind].pull_many(points.data(), cores.data(), core_count, rest_radii.data(), moved.data());
      for (std::size_t k = 0; k < nodes_at_once; ++k) {
        const float enough = 1.01f * rest_radii[k];
        std::array<std::uint32_t, core_size> core;
        for (std::size_t i = 0; i < core_size; ++i) core[i] = cores[nodes_at_once * i + k];
        const Vec3f expected = all_kernels().front().pull(points.data(), {core.data(), enough * enough, rest_radii[k]},
                                                          {centers[k].x, centers[k].y, centers[k].z});
        EXPECT_EQ((Vec3f{moved[k].x, moved[k].y, moved[k].z}), expected) << kind_name(kind) << ", seed " << seed;
      }
    }
  }
}

// What Fits says a leaf costs, and how far it reaches, by brute force.
std::pair<float, float> cost_and_reach(const std::vector<LocalPoint>& points, const Fits& fits, std::size_t leaf,
                                       const LocalPoint& center) {
  const auto distance_to = [&](std::uint32_t i) {
    const LocalPoint& p = points[i];
    return length(Vec3f{p.x, p.y, p.z} - Vec3f{center.x, center.y, center.z});
  };
  float reach = 0, depth = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < core_size; ++i)
    reach = std::max(reach, distance_to(fits.cores[nodes_at_once * i + leaf]));
  for (std::size_t i = 0; i < near_size; ++i) depth = std::min(depth, distance_to(fits.near[nodes_at_once * i + leaf]));
  return {reach * reach - depth * depth, reach};
}

TEST(Kernels, a_fit_never_costs_more_nor_grows_and_agrees_bit_for_bit) {
  int cheaper = 0;
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    std::vector<LocalPoint> points = random_points(64, seed % 3 == 0 ? 1e-3 : 1.0, seed);
    if (seed % 7 == 6)  // a sheet
      for (LocalPoint& p : points) p.z = 0;
    Random random(seed);
    // Some cores are a few points, and some leaves are one point, at the center or elsewhere.
    std::vector<std::uint32_t> cores(core_size * nodes_at_once), near(near_size * nodes_at_once);
    std::vector<LocalPoint> centers(nodes_at_once);
    for (std::size_t k = 0; k < nodes_at_once; ++k) {
      const double kinds = k == 3 ? 1 : k % 4 == 1 ? 5 : 64;
      for (std::size_t i = 0; i < core_size; ++i)
        cores[nodes_at_once * i + k] = static_cast<std::uint32_t>(random.uniform(0, kinds));
      for (std::size_t i = 0; i < near_size; ++i)
        near[nodes_at_once * i + k] = static_cast<std::uint32_t>(random.uniform(0, kinds));
      centers[k] = k == 3 || k == 5 ? points[cores[k]] : points[k];
      centers[k].x *= 0.5f;
    }
    centers[3] = points[cores[3]];
    std::vector<float> enough(nodes_at_once, 0.0f);
    enough[2] = 100, enough[3] = -1;  // a good leaf, and a point that is not
    const Fits fits{cores.data(), near.data(), enough.data()};
    std::vector<LocalPoint> expected = centers;
    all_kernels().front().fit_many(points.data(), fits, expected.data());
    EXPECT_EQ(std::memcmp(&expected[2], &centers[2], sizeof(Vec3f)), 0);
    for (std::size_t k = 0; k < nodes_at_once; ++k) {
      const auto [before, reach_before] = cost_and_reach(points, fits, k, centers[k]);
      const auto [after, reach_after] = cost_and_reach(points, fits, k, expected[k]);
      EXPECT_LE(after, before + 1e-5f * reach_before * reach_before) << "seed " << seed << ", leaf " << k;
      EXPECT_LE(reach_after, 1.0201f * reach_before) << "seed " << seed << ", leaf " << k;
      cheaper += after < 0.9f * before;
    }
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
      std::vector<LocalPoint> fitted = centers;
      all_kernels()[kind].fit_many(points.data(), fits, fitted.data());
      for (std::size_t k = 0; k < nodes_at_once; ++k)
        EXPECT_EQ((Vec3f{fitted[k].x, fitted[k].y, fitted[k].z}), (Vec3f{expected[k].x, expected[k].y, expected[k].z}))
            << kind_name(kind) << ", seed " << seed << ", leaf " << k;
    }
  }
  EXPECT_GT(cheaper, 500);
}

TEST(Kernels, weighted_sums_agree_bit_for_bit) {
  const std::vector<LocalPoint> points = random_points(100, 3.0, 4);
  Random random(3);
  const std::vector<std::uint32_t> group_begin{0, 8, 8, 8 + 6 * 8, 8 + 7 * 8};
  std::vector<std::uint32_t> index(group_begin.back());
  std::vector<float> weight(index.size());
  for (std::size_t i = 0; i < index.size(); ++i) {
    index[i] = static_cast<std::uint32_t>(random.uniform(0, 100));
    weight[i] = i % 5 == 0 ? 0.0f : static_cast<float>(random.uniform(-1, 1));
  }
  for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
    std::vector<LocalPoint> sums(4 * nodes_per_group);
    all_kernels()[kind].weighted_sums(points.data(), index.data(), weight.data(), group_begin, sums.data());
    for (std::size_t k = 0; k < sums.size(); ++k) {
      // As one would by hand: every other anchor, then the rest, then the two.
      Vec3f sum[2]{};
      int which = 0;
      for (std::size_t i = group_begin[k / 4] + k % 4; i < group_begin[k / 4 + 1]; i += 4, which = 1 - which)
        sum[which] += Vec3f{points[index[i]].x, points[index[i]].y, points[index[i]].z} * weight[i];
      const Vec3f expected = sum[0] + sum[1];
      EXPECT_EQ(std::memcmp(&sums[k], &expected, sizeof expected), 0) << kind_name(kind) << ", node " << k;
    }
  }
}

TEST(Kernels, radii_of_many_are_those_of_each) {
  Random random(31);
  for (const double magnitude : {0.0, 1e-30, 1e-3, 1.0, 1e17})
    for (const Rounding& rounding : {Rounding{0, 0, 0}, Rounding{magnitude, 1e9, 0}, Rounding{magnitude, 3, 1e-16}}) {
      std::vector<float> squared(37), norms(37);
      for (std::size_t i = 0; i < squared.size(); ++i) {
        squared[i] = static_cast<float>(magnitude * magnitude * random.uniform(0, i % 5));
        norms[i] = static_cast<float>(magnitude * random.uniform());
      }
      for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
        std::vector<float> radii(squared.size());
        all_kernels()[kind].covering_radii(squared.data(), norms.data(), squared.size(), rounding.allowances(),
                                           radii.data());
        for (std::size_t i = 0; i < squared.size(); ++i)
          EXPECT_EQ(radii[i], rounding.covering_radius(squared[i], {0, -norms[i], 0})) << kind_name(kind);
      }
    }
}

TEST(Kernels, cut_points_agree_bit_for_bit_however_many_they_are) {
  const std::vector<LocalPoint> points = random_points(50, 2.0, 12);
  Random random(6);
  const auto any = [&] { return static_cast<std::uint32_t>(random.uniform(0, 50)); };
  for (std::size_t count = 0; count < 12; ++count) {
    std::vector<EdgeCut> edges(count);
    std::vector<InnerCut> inner(count);
    for (EdgeCut& cut : edges) cut = {{any(), any()}, static_cast<float>(random.uniform(0, 0.5))};
    for (InnerCut& cut : inner)
      cut = {{any(), any(), any()},
             static_cast<float>(random.uniform(0, 0.5)),
             static_cast<float>(random.uniform(0, 0.3))};
    const auto at = [&](std::uint32_t p) { return Vec3f{points[p].x, points[p].y, points[p].z}; };
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
      const LocalPoint untouched{7, 7, 7, 7};
      std::vector<LocalPoint> on_edges(count + 1, untouched), inside(count + 1, untouched);
      all_kernels()[kind].move_edge_cuts(points.data(), edges.data(), count, on_edges.data());
      all_kernels()[kind].move_inner_cuts(points.data(), inner.data(), count, inside.data());
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f a = at(edges[i].point[0]), e = a + (at(edges[i].point[1]) - a) * edges[i].weight;
        EXPECT_EQ(std::memcmp(&on_edges[i], &e, sizeof e), 0) << kind_name(kind);
        const Vec3f b = at(inner[i].point[0]), f = b + (at(inner[i].point[1]) - b) * inner[i].weight1 +
                                                   (at(inner[i].point[2]) - b) * inner[i].weight2;
        EXPECT_EQ(std::memcmp(&inside[i], &f, sizeof f), 0) << kind_name(kind);
      }
      EXPECT_EQ(on_edges[count].x, 7) << kind_name(kind);
      EXPECT_EQ(inside[count].x, 7) << kind_name(kind);
    }
  }
}

TEST(Kernels, all_leaves_in_one_call_reach_what_each_does_alone) {
  const std::vector<LocalPoint> points = random_points(400, 1.0, 21);
  Random random(22);
  const auto any = [&](double end) { return static_cast<std::uint32_t>(random.uniform(0, end)); };
  std::vector<Spheref> spheres(30);
  std::vector<std::uint32_t> nodes(30), run_begin{0}, point_begin{0}, point_end, chain_begin{0}, list, chain;
  std::iota(nodes.rbegin(), nodes.rend(), 0u);
  for (Spheref& s : spheres) s = {{points[any(400)].x, points[any(400)].y, points[any(400)].z}, 0.5f};
  std::vector<PointRun> runs;
  for (std::uint32_t leaf = 0; leaf < 40; ++leaf) {
    for (std::uint32_t r = any(3); r > 0; --r) {
      const std::uint32_t begin = any(300);
      runs.push_back({begin, begin + 16 * (1 + any(4))});
    }
    for (std::uint32_t i = 16 * any(4); i > 0; --i) list.push_back(any(400));
    // Chains of one node to nine, from the top, whose places ascend.
    const std::uint32_t length = 1 + leaf % 9;
    for (std::uint32_t k = 0; k < length; ++k) chain.push_back(3 * k + any(3));
    // Those further down look at as many points or more.
    std::uint32_t end = point_begin.back();
    for (std::uint32_t k = 0; k < length; ++k) {
      end += 16 * any(static_cast<double>((list.size() - end) / 16 + 1));
      point_end.push_back(end);
    }
    run_begin.push_back(static_cast<std::uint32_t>(runs.size()));
    point_begin.push_back(static_cast<std::uint32_t>(list.size()));
    chain_begin.push_back(static_cast<std::uint32_t>(chain.size()));
  }
  const LeafLists lists{runs.data(),      run_begin.data(), list.data(),        point_begin.data(),
                        point_end.data(), chain.data(),     chain_begin.data(), nodes.data()};
  for (const std::size_t count : {std::size_t{0}, std::size_t{7}, std::size_t{30}})
    for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
      std::vector<float> squared(chain.size(), -1.0f);
      all_kernels()[kind].farthest_of_leaves(points.data(), lists, 3, 38, count, spheres.data(), squared.data());
      for (std::uint32_t leaf = 0; leaf < 40; ++leaf)
        for (std::uint32_t e = chain_begin[leaf]; e < chain_begin[leaf + 1]; ++e) {
          float expected = -1;
          if (leaf >= 3 && leaf < 38 && chain[e] < count) {
            const Vec3f& center = spheres[29 - chain[e]].center;
            const auto see = [&](const LocalPoint& p) {
              expected = std::max(expected, squared_distance(center, {p.x, p.y, p.z}));
            };
            expected = 0;
            for (std::uint32_t r = run_begin[leaf]; r < run_begin[leaf + 1]; ++r)
              for (std::uint32_t i = runs[r].begin; i < runs[r].end; ++i) see(points[i]);
            for (std::uint32_t i = point_begin[leaf]; i < point_end[e]; ++i) see(points[list[i]]);
          }
          EXPECT_EQ(squared[e], expected) << kind_name(kind) << ", leaf " << leaf << ", entry " << e;
        }
    }
}

TEST(Kernels, narrowing_of_packed_floats_agrees_bit_for_bit_and_tells_what_is_not_finite) {
  Random random(5);
  for (const std::size_t count : {1u, 2u, 3u, 4u, 7u, 8u, 9u, 15u, 64u, 1001u}) {
    // Exactly as long as needed: an address sanitizer sees a load beyond the end.
    std::vector<float> packed(3 * count);
    for (float& x : packed) x = static_cast<float>(random.uniform(-3, 3));
    const Vec3f origin{0.25f, -7.5f, 0.1f};
    std::vector<std::uint32_t> to(2 * count);
    std::iota(to.begin(), to.end(), 0u);
    for (std::size_t i = to.size(); i > 1; --i)
      std::swap(to[i - 1], to[static_cast<std::size_t>(random.uniform(0, static_cast<double>(i)))]);
    to.resize(count);  // exactly as long as needed, too
    to.shrink_to_fit();
    std::vector<LocalPoint> anywhere(2 * count);
    for (const float bad : {0.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      const auto at = static_cast<std::size_t>(random.uniform(0, static_cast<double>(packed.size())));
      const float kept = packed[at];
      if (bad != 0) packed[at] = bad;
      std::vector<LocalPoint> expected(count), found(count);
      const std::uint32_t largest = all_kernels().front().narrow_floats(packed.data(), count, origin, expected.data());
      EXPECT_EQ(largest >= 0x7f800000u, bad != 0);
      for (std::size_t kind = 0; kind < all_kernels().size(); ++kind) {
        const Kernels& kernel = all_kernels()[kind];
        const std::uint32_t found_largest = kernel.narrow_floats(packed.data(), count, origin, found.data());
        EXPECT_EQ(found_largest >= 0x7f800000u, bad != 0) << kind_name(kind);
        EXPECT_EQ(kernel.narrow_scattered(packed.data(), count, origin, to.data(), anywhere.data()) >= 0x7f800000u,
                  bad != 0)
            << kind_name(kind);
        if (bad != 0) continue;
        EXPECT_EQ(found_largest, largest) << kind_name(kind);
        EXPECT_EQ(std::memcmp(found.data(), expected.data(), count * sizeof(LocalPoint)), 0) << kind_name(kind);
        // And each in a place of its own among twice as many.
        constexpr LocalPoint untouched{1, 2, 3, 4};
        std::vector<LocalPoint> scattered(2 * count, untouched);
        EXPECT_EQ(kernel.narrow_scattered(packed.data(), count, origin, to.data(), scattered.data()), largest)
            << kind_name(kind);
        for (std::size_t i = 0; i < count; ++i) {
          EXPECT_EQ(std::memcmp(&scattered[to[i]], &expected[i], sizeof(LocalPoint)), 0)
              << kind_name(kind) << ", vertex " << i;
          scattered[to[i]] = untouched;
        }
        for (const LocalPoint& p : scattered) EXPECT_EQ(std::memcmp(&p, &untouched, sizeof p), 0) << kind_name(kind);
      }
      packed[at] = kept;
    }
  }
}

TEST(Kernels, narrowing_agrees_with_its_plain_twin) {
  Random random(4);
  constexpr float bad_floats[]{std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity()};
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Vec3> positions;
    const double magnitude = std::exp2(random.uniform(-60, 60));
    for (int i = 0; i < 50; ++i)
      positions.push_back(
          {random.uniform(-1, 1) * magnitude, random.uniform(-1, 1) * magnitude, random.uniform(-1, 1)});
    std::vector<Vec3f> floats;
    for (const Vec3& p : positions) floats.emplace_back(p);
    if (trial % 3 == 1) {
      const auto v = static_cast<std::size_t>(random.uniform(0, 50));
      const int axis = static_cast<int>(random.uniform(0, 3));
      floats[v][axis] = bad_floats[trial % 9 / 3];
      positions[v][axis] = trial % 2 == 0 ? 1e300 : static_cast<double>(floats[v][axis]);
    }
    const auto first = static_cast<std::size_t>(random.uniform(0, 14));
    constexpr std::size_t count = 37;
    std::vector<std::uint32_t> to(count);
    for (std::uint32_t i = 0; i < count; ++i) to[i] = (i * 10 + 3) % count;
    const Vec3 anywhere{random.uniform(-1, 1) * magnitude, random.uniform(-9, 9), 1e9 * random.uniform()};
    const Vec3 origin = trial % 2 == 0 ? anywhere : nearest_floats(anywhere);
    ASSERT_EQ(origin == anywhere, trial % 2 == 0);
    std::vector<std::uint32_t> index(50);
    for (std::uint32_t& node : index) node = static_cast<std::uint32_t>(random.uniform(0, 50));
    for (const PositionView& view : {PositionView(positions), PositionView(floats),
                                     PositionView::indexed(positions, index), PositionView::indexed(floats, index)}) {
      std::vector<LocalPoint> wide(count), plain(count), scattered(count);
      const float largest = narrow_plainly(view, first, count, origin, plain.data());
      EXPECT_EQ(narrow(view, first, count, origin, wide.data()), largest);
      EXPECT_EQ(narrow_scattered(view, first, count, origin, to.data(), scattered.data()), largest);
      for (std::size_t i = 0; i < count; ++i)
        for (const auto coordinate : {&LocalPoint::x, &LocalPoint::y, &LocalPoint::z, &LocalPoint::unused})
          for (const LocalPoint& found : {wide[i], scattered[to[i]]}) {
            const float a = found.*coordinate, b = plain[i].*coordinate;
            EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
          }
    }
  }
}

}  // namespace
}  // namespace morula
