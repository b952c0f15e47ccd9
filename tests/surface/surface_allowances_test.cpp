// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Allowances of surface queries at their limits: each fails without the one it is named after.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <support/meshes.hpp>
#include <support/transforms.hpp>

namespace morula {
namespace {

/// A facet far along x and one whose distance from it along an axis is just within the one asked for.
Mesh single(const Vec3& at, double size = 1) {
  return {{at, at + Vec3{0, size, 0}, at + Vec3{0, 0, size}}, {{0, 1, 2}}};
}

TEST(SurfaceAllowance, pays_for_distances_computed_far_from_the_origin) {
  Random random(2);
  std::size_t total = 0;
  for (int round = 0; round < 2000; ++round) {
    const Vec3 far = test::random_point(random, round % 2 == 0 ? 1e12 : 1e5);
    // A vertex opposite the inside of a facet: the distance is that along x, but for the rounding of the nearest point.
    const double gap = random.uniform(0.1, 1);
    const Mesh a = single(far), b = single(far + Vec3{gap, -random.uniform(), -random.uniform()}, 8);
    const Mesh both = test::joined(a, b);
    SurfaceTree tree(both), tree_a(a), tree_b(b);
    const auto expect_itself_found = [&](const auto& ask) {
      ProximityQuery all({.distance = 10});
      ASSERT_TRUE(ask(all));
      for (const ProximityPair& pair : all.pairs()) {
        ProximityQuery query({.distance = pair.distance});
        ASSERT_TRUE(ask(query));
        const auto found = query.pairs();
        EXPECT_TRUE(std::any_of(found.begin(), found.end(), [&](const FeaturePair& p) { return p == pair; }));
        ++total;
      }
    };
    expect_itself_found([&](ProximityQuery& query) { return query.run(tree); });
    expect_itself_found([&](ProximityQuery& query) { return query.run(tree_a, tree_b); });
  }
  EXPECT_GT(total, 10000u);
}

TEST(SurfaceAllowance, pays_for_rounding_the_distance_to_float) {
  Random random(5);
  std::size_t rounded_down = 0;
  for (int round = 0; round < 3000; ++round) {
    // Two facets across the x axis at floats, whose distance has a bit more than a float. The box's middle is 0.
    const auto bits = static_cast<double>(random.next() % 64) * 0x1p-23;
    Mesh mesh = test::joined(single({-1 - bits, -0.5, -0.5}), single({1 + bits + 0x1p-23, -0.5, -0.5}));
    mesh = test::joined(mesh, single({-4, -0.5, -0.5}));
    mesh = test::joined(mesh, single({4, -0.5, -0.5}));
    SurfaceTree tree(mesh);
    const double distance = 2 + 2 * bits + 0x1p-23;
    rounded_down += static_cast<double>(static_cast<float>(distance)) < distance;
    ProximityQuery query({.distance = distance});
    ASSERT_TRUE(query.run(tree));
    const auto found = query.pairs();
    // Three vertices are opposite, either way; and edges.
    EXPECT_GE(std::count_if(found.begin(), found.end(),
                            [](const FeaturePair& p) { return p.kind == PairKind::vertex_facet; }),
              6);
  }
  EXPECT_GT(rounded_down, 500u);
}

TEST(SurfaceAllowance, of_impacts_pays_for_rounding_where_features_touch_and_part) {
  Random random(3);
  const auto whole = [&](int bits) {
    const auto range = static_cast<std::int64_t>(1) << bits;
    const auto one = [&] {
      return static_cast<double>(static_cast<std::int64_t>(random.next() % static_cast<std::uint64_t>(2 * range)) -
                                 range);
    };
    return Vec3{one(), one(), one()};
  };
  for (int round = 0; round < 20000; ++round) {
    // Corners are multiples of 8, so that eighths of their differences are whole: no coordinate is rounded.
    const Vec3 a = whole(40) * 8, b = whole(40) * 8, c = whole(40) * 8;
    const double u = static_cast<double>(random.next() % 9) / 8;
    const Vec3 touched = a + (b - a) * u;
    // A vertex on an edge of the facet, which moves off; and an edge that ends there.
    const Vec3 away = whole(40), other = touched + whole(40);
    const std::vector<Vec3> facet{a, b, c}, edge{a, b};
    EXPECT_EQ(time_of_impact(std::vector<Vec3>{touched}, std::vector<Vec3>{touched + away}, facet, facet), 0);
    EXPECT_EQ(
        time_of_impact(std::vector<Vec3>{touched, other}, std::vector<Vec3>{touched + away, other + away}, edge, edge),
        0);
    // And one that arrives at the end of the step.
    EXPECT_LE(time_of_impact(std::vector<Vec3>{touched + away}, std::vector<Vec3>{touched}, facet, facet), 1);
    EXPECT_LE(
        time_of_impact(std::vector<Vec3>{touched + away, other + away}, std::vector<Vec3>{touched, other}, edge, edge),
        1);
  }
}

TEST(SurfaceAllowance, of_impacts_counts_the_distance_along_directions_of_any_length) {
  Random random(4);
  for (int round = 0; round < 2000; ++round) {
    // The nearest points come as near as the distance at half the step, straight towards each other.
    const RigidTransform turn = test::random_transform(random, 10);
    const double distance = random.uniform(0.01, 1), height = random.uniform(2, 5);
    const std::vector<Vec3> facet{turn({-1, -1, 0}), turn({2, -1, 0}), turn({-1, 2, 0})};
    const std::vector<Vec3> from{turn({0, 0, distance + height})}, to{turn({0, 0, distance - height})};
    const double time = time_of_impact(from, to, facet, facet, distance);
    EXPECT_LE(time, 0.5 + 1e-12);
    EXPECT_GT(time, 0.5 - 1e-6);
  }
}

// A direction that turns from an axis to a diagonal, or back, changes its length, which is measured by the largest
// coordinate: what counts as an impact is farther along the longer one. Features of nearly no size, so that distances
// are those of points, known in closed form.
TEST(SurfaceAllowance, of_impacts_is_that_of_the_longer_one_of_two_directions) {
  constexpr double tiny = 0x1p-30;
  const Vec3 axis{2, 0, 0}, diagonal{0.45, 0.45, 0.45};
  const std::vector<Vec3> facet{{0, 0, 0}, {-tiny, 0, 0}, {0, -tiny, 0}}, edge{{0, 0, 0}, {-tiny, -tiny, -tiny}};
  // |(2 - 1.55 t, 0.45 t, 0.45 t)| = 1
  const double impact = (6.2 - std::sqrt(6.2 * 6.2 - 4 * 2.8075 * 3)) / (2 * 2.8075);
  ASSERT_NEAR(length(axis + (diagonal - axis) * impact), 1, 1e-12);
  for (const Vec3& signs : {Vec3{1, 1, 1}, Vec3{-1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, -1, -1}})
    for (int turns = 0; turns < 3; ++turns) {
      const auto placed = [&](const Vec3& p) {
        Vec3 q{p.x * signs.x, p.y * signs.y, p.z * signs.z};
        for (int k = 0; k < turns; ++k) q = {q.z, q.x, q.y};
        return q;
      };
      const auto all_placed = [&](std::vector<Vec3> points) {
        for (Vec3& p : points) p = placed(p);
        return points;
      };
      const std::vector<Vec3> point_far{placed(axis)}, point_near{placed(diagonal)};
      const std::vector<Vec3> edge_far{placed(axis), placed(axis + Vec3{tiny, tiny, tiny})};
      const std::vector<Vec3> edge_near{placed(diagonal), placed(diagonal + Vec3{tiny, tiny, tiny})};
      const std::vector<Vec3> other = all_placed(facet), other_edge = all_placed(edge);
      EXPECT_LE(time_of_impact(point_far, point_near, other, other, 1), impact + 1e-6);
      EXPECT_LE(time_of_impact(other, other, point_far, point_near, 1), impact + 1e-6);
      EXPECT_LE(time_of_impact(edge_far, edge_near, other_edge, other_edge, 1), impact + 1e-6);
      // It begins with an impact.
      EXPECT_EQ(time_of_impact(point_near, point_far, other, other, 1), 0);
      EXPECT_EQ(time_of_impact(other, other, point_near, point_far, 1), 0);
      EXPECT_EQ(time_of_impact(edge_near, edge_far, other_edge, other_edge, 1), 0);
    }
}

}  // namespace
}  // namespace morula
