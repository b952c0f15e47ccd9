// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Centers that are tied to points of the surface.
#include "update/rules/anchors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <morula/geometry/reproducible.hpp>
#include <numeric>
#include <vector>

#include "../bodies.hpp"
#include "../points/random_points.hpp"
#include "simd/processors.hpp"

namespace morula {
using namespace detail;
namespace {

using test::random_points;

std::vector<LocalPoint> local(const std::vector<Vec3>& positions) {
  std::vector<LocalPoint> points;
  for (const Vec3& p : positions)
    points.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z), 0});
  return points;
}

// Anchors on one side only, on a plane, on a line, in a point, none: rest is kept and rigid motion carries the center
// to where its distances to the anchors are the same.
TEST(Anchors, distances_to_anchors_survive_rigid_motion_however_few_they_are) {
  Random random(5);
  for (int dimensions = 0; dimensions <= 3; ++dimensions)
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<Vec3> rest;
      const Vec3 a{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      const Vec3 b{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
      for (int i = 0; i < 40; ++i)
        rest.push_back(dimensions == 0   ? a
                       : dimensions == 1 ? a * random.uniform(-1, 1)
                       : dimensions == 2 ? a * random.uniform(-1, 1) + b * random.uniform(-1, 1)
                                         : Vec3{random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)});
      const Vec3f center{1.2f, -0.4f, 0.3f};
      std::vector<std::uint32_t> candidates(rest.size());
      for (std::uint32_t i = 0; i < candidates.size(); ++i) candidates[i] = i;
      Anchors anchors;
      anchors.tie(center, 1.0f, local(rest), candidates);
      EXPECT_EQ(anchors[0].degenerate, dimensions < 3);
      EXPECT_EQ(anchors.center(0, local(rest)), center);
      for (const double degrees : {17.0, 90.0, 180.0}) {
        const Vec3 axis = trial % 2 == 0 ? a : Vec3{0.3, -1, 0.8};
        const auto moved = test::translated(test::rotated(rest, axis, degrees), {0.5, 1, -2});
        const Vec3f now = anchors.center(0, local(moved));
        for (std::size_t i = 0; i < rest.size(); ++i)
          EXPECT_NEAR(distance(Vec3(now), moved[i]), distance(Vec3(center), rest[i]), 2e-5)
              << dimensions << " dimensions, trial " << trial << ", " << degrees << " degrees";
      }
    }
  Anchors none;
  none.tie({1, 2, 3}, 1.0f, {}, {});
  EXPECT_EQ(none.center(0, {}), (Vec3f{1, 2, 3}));
}

// A narrow triangle is all that tells how these points turn; it must not make the frame skew.
TEST(Anchors, nearly_collinear_anchors_carry_the_center_as_well) {
  Random random(6);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<Vec3> rest;
    const Vec3 along = normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    const Vec3 across = cross(along, Vec3{0.3, -0.8, 0.5});
    for (int i = 0; i < 20; ++i) rest.push_back(along * random.uniform(-1, 1) + across * random.uniform(0, 1e-4));
    const Vec3f center(across * 2.0 + along * 0.3);
    Anchors anchors;
    std::vector<std::uint32_t> candidates(rest.size());
    std::iota(candidates.begin(), candidates.end(), 0u);
    anchors.tie(center, 1.0f, local(rest), candidates);
    const std::vector<Vec3> moved = test::rotated(rest, {1, 2, 3}, 100);
    const Vec3f now = anchors.center(0, local(moved));
    for (std::size_t i = 0; i < rest.size(); ++i)
      EXPECT_NEAR(distance(Vec3(now), moved[i]), distance(Vec3(center), rest[i]), 5e-6) << "trial " << trial;
  }
}

// The near points of a shallow cap all lie above a center just inside it; those of its rim put it in their hull.
TEST(Anchors, a_center_inside_the_hull_of_its_candidates_needs_no_remainder) {
  std::vector<Vec3> cap;
  for (int i = -20; i <= 20; ++i)
    for (int j = -20; j <= 20; ++j)
      if (const double x = i / 40.0, y = j / 40.0; x * x + y * y <= 0.25) cap.push_back({x, y, -0.5 * (x * x + y * y)});
  std::vector<std::uint32_t> candidates(cap.size());
  std::iota(candidates.begin(), candidates.end(), 0u);
  for (const double depth : {0.01, 0.05, 0.1, 0.12}) {
    Anchors anchors;
    anchors.tie(Vec3f(Vec3{0.01, -0.02, -depth}), 0.5f, local(cap), candidates);
    EXPECT_FALSE(anchors[0].carries) << depth;
    EXPECT_FALSE(anchors[0].degenerate);
    EXPECT_GE(anchors[0].end - anchors[0].begin, 4u);
    EXPECT_LE(anchors[0].end - anchors[0].begin, 24u);
  }
}

// Centers inside and outside of their anchors' hull, anchors on a plane, on a line, in a point, none; also after these
// have come to lie on a line or in a point.
TEST(Anchors, many_centers_at_once_are_what_each_is_alone) {
  Random random(14);
  constexpr std::size_t count = 39;
  std::vector<LocalPoint> rest = random_points(300, 1.0, 15);
  for (std::size_t i = 100; i < 150; ++i) rest[i].z = 0;
  for (std::size_t i = 150; i < 200; ++i) rest[i] = {rest[i].x, 2 * rest[i].x, -rest[i].x, 0};
  for (std::size_t i = 200; i < 220; ++i) rest[i] = rest[200];
  Anchors anchors;
  std::size_t carrying = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t first = k % 6 == 5 ? 0 : std::array{0, 100, 150, 200, 40}[k % 6];
    std::vector<std::uint32_t> candidates(k % 6 == 5 ? 0 : 3 + k % 20);
    std::iota(candidates.begin(), candidates.end(), static_cast<std::uint32_t>(first));
    const double away = k % 2 == 0 ? 3 : 0.3;
    anchors.tie(Vec3f(Vec3{random.uniform(-away, away), random.uniform(-away, away), away}), 1.0f, rest, candidates);
    carrying += anchors[k].carries;
  }
  EXPECT_GT(carrying, nodes_at_once);
  std::vector<std::vector<LocalPoint>> poses{rest, random_points(300, 1.0, 16), rest, rest, rest};
  for (LocalPoint& p : poses[2]) p = {p.y + 5, -p.x, p.z, 0};
  for (LocalPoint& p : poses[3]) p = {p.x, 0, 0, 0};
  for (LocalPoint& p : poses[4]) p = {0.5f, 0.25f, -1, 0};
  std::vector<std::vector<Vec3f>> expected;
  for (const auto& pose : poses) {
    expected.emplace_back();
    for (std::size_t k = 0; k < count; ++k) expected.back().push_back(anchors.center(k, pose));
  }
  anchors.pack();
  const std::size_t kinds = runnable_kinds();
  for (std::size_t most = 1; most <= kinds; ++most) {
    allow_kinds(most);
    for (std::size_t pose = 0; pose < poses.size(); ++pose)
      for (const std::size_t begin : {std::size_t{0}, std::size_t{16}}) {
        std::vector<LocalPoint> found(count + nodes_per_group);
        anchors.centers(begin, count, poses[pose], found.data());
        for (std::size_t k = begin; k < count; ++k) {
          EXPECT_EQ(std::memcmp(&found[k - begin], &expected[pose][k], sizeof(Vec3f)), 0)
              << kind_name(most - 1) << ", pose " << pose << ", center " << k;
          EXPECT_EQ(anchors.center(k, poses[pose]), expected[pose][k]) << "packed";
        }
      }
  }
  allow_kinds(kinds);
}

TEST(Anchors, weights_add_up_to_one_so_translation_carries_the_center_along) {
  const std::vector<LocalPoint> rest = random_points(200, 1.0, 9);
  std::vector<std::uint32_t> candidates(rest.size());
  for (std::uint32_t i = 0; i < candidates.size(); ++i) candidates[i] = i;
  for (const Vec3f& center : {Vec3f{0, 0, 0}, Vec3f{0.5f, 0.2f, -0.4f}, Vec3f{3, 0, 0}}) {
    Anchors anchors;
    anchors.tie(center, 1.0f, rest, candidates);
    std::vector<LocalPoint> moved = rest;
    for (LocalPoint& p : moved) p.x += 64, p.z -= 16;
    EXPECT_LE(distance(anchors.center(0, moved), center + Vec3f{64, 0, -16}), 1e-4f);
    EXPECT_EQ(anchors[0].carries, center.x == 3);
  }
}

}  // namespace
}  // namespace morula
