// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features, and bounds of distances, of the C interface: all pairs of features judge them.
#include <gtest/gtest.h>
#include <morula/morula.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <morula/geometry/vector.hpp>
#include <vector>

#include "pair_body.hpp"

namespace morula {
namespace {

using test::Key;
using test::keys_of;
using test::PairBody;
using test::vertices_of;

double squared(const Vec3& v) {
  return dot(v, v);
}

/// Distance of two convex hulls of few points, by descending along one weight at a time: slow, and free of cases.
double hull_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  // Frank-Wolfe with exact steps between pairs of corners: the difference of two corners of the least and the largest
  // slope takes weight from one another.
  struct Corner {
    Vec3 at;
    double weight;
  };
  std::vector<Corner> corners;
  for (const Vec3& p : a)
    for (const Vec3& q : b) corners.push_back({p - q, 0});
  corners[0].weight = 1;
  Vec3 now = corners[0].at;
  for (int step = 0; step < 20000; ++step) {
    std::size_t low = 0, high = corners.size();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      if (dot(corners[i].at, now) < dot(corners[low].at, now)) low = i;
      if (corners[i].weight > 0 && (high == corners.size() || dot(corners[i].at, now) > dot(corners[high].at, now)))
        high = i;
    }
    const Vec3 way = corners[low].at - corners[high].at;
    const double slope = -dot(way, now);
    if (slope <= 1e-16 || squared(way) == 0) break;
    const double amount = std::min(slope / squared(way), corners[high].weight);
    corners[low].weight += amount, corners[high].weight -= amount;
    now = now + way * amount;
  }
  return std::sqrt(squared(now));
}

std::vector<Vec3> corners_of(const PairBody& body, const std::vector<std::uint32_t>& vertices) {
  std::vector<Vec3> corners;
  for (const std::uint32_t vertex : vertices) corners.push_back(body.corner(vertex));
  return corners;
}

struct Found {
  std::vector<Key> surely, perhaps;  // within the distance, and within it up to rounding
};

void collect(int kind, const PairBody& a, const std::vector<std::vector<std::uint32_t>>& of_a, const PairBody& b,
             const std::vector<std::vector<std::uint32_t>>& of_b, double distance, Found& found) {
  for (const auto& first : of_a)
    for (const auto& second : of_b) {
      const bool share = a.body == b.body && std::any_of(first.begin(), first.end(), [&](std::uint32_t vertex) {
                           return std::find(second.begin(), second.end(), vertex) != second.end();
                         });
      if (share || (a.body == b.body && kind == MORULA_EDGE_EDGE && first > second)) continue;
      Key key{kind, first, second};
      std::sort(std::get<1>(key).begin(), std::get<1>(key).end());
      std::sort(std::get<2>(key).begin(), std::get<2>(key).end());
      const double d = hull_distance(corners_of(a, first), corners_of(b, second));
      if (d < distance - 1e-5) found.surely.push_back(key);
      if (d < distance + 1e-5) found.perhaps.push_back(key);
    }
}

Found all_within(const PairBody& a, const PairBody& b, double distance) {
  std::vector<std::vector<std::uint32_t>> points_a, points_b;
  for (std::uint32_t v = 0; v < a.vertex_count(); ++v) points_a.push_back({v});
  for (std::uint32_t v = 0; v < b.vertex_count(); ++v) points_b.push_back({v});
  Found found;
  collect(MORULA_VERTEX_FACET, a, points_a, b, b.facets(), distance, found);
  if (a.body != b.body) collect(MORULA_FACET_VERTEX, a, a.facets(), b, points_b, distance, found);
  collect(MORULA_EDGE_EDGE, a, a.edges(), b, b.edges(), distance, found);
  std::sort(found.surely.begin(), found.surely.end());
  std::sort(found.perhaps.begin(), found.perhaps.end());
  return found;
}

void expect_found(const Found& expected, const morula_pairs* pairs) {
  const std::vector<Key> keys = keys_of(pairs);
  EXPECT_TRUE(std::includes(keys.begin(), keys.end(), expected.surely.begin(), expected.surely.end()));
  EXPECT_TRUE(std::includes(expected.perhaps.begin(), expected.perhaps.end(), keys.begin(), keys.end()));
}

/// The points of a pair are combinations of its vertices, and as far apart as it says.
void expect_points(const PairBody& a, const PairBody& b, const morula_pair& pair) {
  Vec3 of_a{}, of_b{};
  for (int i = 0; i < 3; ++i) {
    if (pair.vertices_a[i] != UINT32_MAX) of_a = of_a + a.corner(pair.vertices_a[i]) * pair.weights_a[i];
    if (pair.vertices_b[i] != UINT32_MAX) of_b = of_b + b.corner(pair.vertices_b[i]) * pair.weights_b[i];
  }
  const Vec3 point_a{pair.point_a[0], pair.point_a[1], pair.point_a[2]};
  const Vec3 point_b{pair.point_b[0], pair.point_b[1], pair.point_b[2]};
  EXPECT_LT(squared(of_a - point_a), 1e-20);
  EXPECT_LT(squared(of_b - point_b), 1e-20);
  EXPECT_NEAR(std::sqrt(squared(point_a - point_b)), pair.distance, 1e-9);
}

TEST(CPairs, near_pairs_are_those_of_all_features) {
  const PairBody limb("limb");
  PairBody torus("torus", 8);
  morula_pairs* pairs = nullptr;
  ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
  morula_pair_options options;
  morula_pair_options_init(&options);
  options.distance = 0.2;
  std::size_t seen = 0;
  for (const double height : {0.0, 0.45, 5.0}) {
    torus.move({0.3, 0.05, height});
    ASSERT_EQ(morula_pairs_near(limb.body, torus.body, &options, pairs), MORULA_OK) << morula_message();
    EXPECT_TRUE(morula_pairs_finished(pairs));
    expect_found(all_within(limb, torus, options.distance), pairs);
    for (std::size_t i = 0; i < morula_pairs_count(pairs); ++i) expect_points(limb, torus, morula_pairs_data(pairs)[i]);
    seen += morula_pairs_count(pairs);
  }
  EXPECT_GT(seen, 100u);
  // One body with itself, by both ways of saying so.
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  const std::vector<Key> keys = keys_of(pairs);
  expect_found(all_within(limb, limb, options.distance), pairs);
  EXPECT_GT(keys.size(), 10u);
  ASSERT_EQ(morula_pairs_near(limb.body, limb.body, &options, pairs), MORULA_OK);
  EXPECT_EQ(keys_of(pairs), keys);
  options.rings = 1;
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  EXPECT_LT(morula_pairs_count(pairs), keys.size());
  options.rings = 0, options.rest_distance = 0.2;
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  EXPECT_EQ(morula_pairs_count(pairs), 0u) << "at rest";
  options.rest_distance = 0, options.same_component = 1;
  ASSERT_EQ(morula_pairs_near(limb.body, nullptr, &options, pairs), MORULA_OK);
  EXPECT_EQ(morula_pairs_count(pairs), 0u) << "one component";
  morula_pairs_destroy(pairs);
}

TEST(CPairs, crossing_pairs_are_the_crossings) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12, {0.2, 0.1, 0.1});
  morula_pairs* pairs = nullptr;
  ASSERT_EQ(morula_pairs_create(&pairs), MORULA_OK);
  ASSERT_EQ(morula_pairs_crossing(limb.body, torus.body, nullptr, pairs), MORULA_OK) << morula_message();
  std::size_t count = 0;
  std::vector<std::uint32_t> list(1 << 16);
  ASSERT_EQ(morula_crossings(limb.body, torus.body, list.data(), list.size() / 2, &count), MORULA_OK);
  ASSERT_EQ(morula_pairs_count(pairs), count);
  EXPECT_GT(count, 5u);
  const auto facets = limb.facets();
  for (std::size_t i = 0; i < count; ++i) {
    const morula_pair& pair = morula_pairs_data(pairs)[i];
    EXPECT_EQ(pair.kind, MORULA_FACET_FACET);
    EXPECT_EQ(pair.a, list[2 * i]);
    EXPECT_EQ(pair.b, list[2 * i + 1]);
    auto vertices = facets[pair.a];
    std::sort(vertices.begin(), vertices.end());
    EXPECT_EQ(vertices_of(pair.vertices_a), vertices);
  }
  morula_pairs_destroy(pairs);
}

TEST(CPairs, bounds_contain_the_distance) {
  const PairBody limb("limb", 12);
  PairBody torus("torus", 12, {0.2, 0.1, 1.5});
  morula_distance exact;
  ASSERT_EQ(morula_distance_of(limb.body, torus.body, &exact), MORULA_OK);
  const auto bounds = [&](const auto& set, int& complete) {
    morula_distance_options options;
    morula_distance_options_init(&options);
    set(options);
    morula_distance result;
    EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, &options, &result, &complete), MORULA_OK)
        << morula_message();
    EXPECT_LE(result.lower, exact.upper);
    EXPECT_GE(result.upper, exact.lower);
    return result;
  };
  int complete = 0;
  const morula_distance same = bounds([](auto&) {}, complete);
  EXPECT_EQ(complete, 1);
  EXPECT_EQ(same.lower, exact.lower);
  EXPECT_EQ(same.upper, exact.upper);
  EXPECT_EQ(same.facet_a, exact.facet_a);
  const morula_distance none = bounds([](auto& o) { o.pair_tests = 0; }, complete);
  EXPECT_EQ(complete, 0);
  EXPECT_GT(none.upper - none.lower, exact.upper - exact.lower);
  const morula_distance rough = bounds([](auto& o) { o.tolerance = 0.5; }, complete);
  EXPECT_EQ(complete, 1);
  EXPECT_LE(rough.upper - rough.lower, 0.5);
  const morula_distance far = bounds([](auto& o) { o.stop_above = 0.01; }, complete);
  EXPECT_EQ(complete, 1);
  EXPECT_GT(far.lower, 0.01);
  bounds([](auto& o) { o.stop_below = 100; }, complete);
  EXPECT_EQ(complete, 1);

  morula_distance_options options;
  morula_distance_options_init(&options);
  morula_distance result;
  options.tolerance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, &options, &result, &complete), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, nullptr, &result, nullptr), MORULA_BAD_ARGUMENT);
  EXPECT_EQ(morula_distance_bounds(limb.body, nullptr, nullptr, &result, &complete), MORULA_BAD_ARGUMENT);
  options.tolerance = 0, options.pair_tests = 1, options.nanoseconds = 1;
  EXPECT_EQ(morula_distance_bounds(limb.body, torus.body, &options, &result, &complete), MORULA_BAD_ARGUMENT);
}

}  // namespace
}  // namespace morula
