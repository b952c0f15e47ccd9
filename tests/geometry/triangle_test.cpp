// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/triangle.hpp>
#include <numbers>
#include <support/transforms.hpp>

namespace morula {
namespace {

TEST(Triangle, closest_point_is_nearer_than_every_point_of_a_fine_grid) {
  Random random(7);
  for (int trial = 0; trial < 300; ++trial) {
    Triangle t{test::random_point(random, 1), test::random_point(random, 1), test::random_point(random, 1)};
    if (trial % 5 == 1) t[2] = t[0] + (t[1] - t[0]) * 0.3;  // a segment
    if (trial % 5 == 2) t[2] = t[1];                        // a repeated corner
    if (trial % 5 == 3) t = {t[0], t[0], t[0]};             // a point
    const Vec3 p = test::random_point(random, 2);
    const TrianglePoint found = closest_point(t, p);
    const auto& b = found.barycentric;
    EXPECT_NEAR(b[0] + b[1] + b[2], 1, 1e-12);
    EXPECT_TRUE(b[0] >= 0 && b[1] >= 0 && b[2] >= 0);
    EXPECT_LT(distance(at_barycentric(t, b), found.point), 1e-12);
    EXPECT_NEAR(found.squared_distance, squared_distance(found.point, p), 1e-12);
    constexpr int n = 40;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const Vec3 q = at_barycentric(t, {1.0 * i / n, 1.0 * j / n, 1.0 * (n - i - j) / n});
        EXPECT_LE(found.squared_distance, squared_distance(q, p) + 1e-12);
      }
  }
}

// A point above a known place of the triangle is no farther from it than from that place: with every corner as the
// first one, sides from 1 down to 10^-16, and angles from 90 degrees down to that.
TEST(Triangle, closest_point_of_needles_and_slivers_is_as_near_as_any) {
  Random random(11);
  for (int trial = 0; trial < 60'000; ++trial) {
    const double width = std::pow(10.0, random.uniform(-16, 0)), height = std::pow(10.0, random.uniform(-14, 0));
    const Vec3 a = test::random_point(random, 1), b = test::random_point(random, 1);
    const double along = trial % 3 == 0 ? 0 : trial % 3 == 1 ? 1 : random.uniform(0, 1);
    const Vec3 c = a + (b - a) * along + test::random_point(random, width);
    const auto first = static_cast<std::size_t>(trial / 3 % 3);
    const std::array<Vec3, 3> corners{a, b, c};
    const Triangle t{corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
    double u = random.uniform(0, 1), v = random.uniform(0, 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 place = at_barycentric(t, {1 - u - v, u, v});
    const Vec3 p = place + normalized(cross(t[1] - t[0], t[2] - t[0])) * height;
    const TrianglePoint found = closest_point(t, p);
    ASSERT_LE(std::sqrt(found.squared_distance), distance(p, place) + 0x1p-50)
        << "trial " << trial << ", width " << width << ", height " << height;
    const auto& weights = found.barycentric;
    ASSERT_TRUE(weights[0] >= 0 && weights[1] >= 0 && weights[2] >= 0) << trial;
    ASSERT_LT(distance(at_barycentric(t, weights), found.point), 0x1p-50) << trial;
  }
}

// Where sides nearly cancel, a share may not be changed without the other one.
TEST(Triangle, closest_point_of_flat_corners_is_as_near_as_any) {
  // 4e-15 from its inside, and from no edge nearer than that.
  const Triangle known{Vec3{0.67735358550744129, -0.9890345259043134, -0.973296316067781},
                       Vec3{0.67735358550442948, -0.98903452590902385, -0.97329631606948641},
                       Vec3{0.67735358550798075, -0.98903452590347019, -0.97329631606747191}};
  const Vec3 above{0.67735358550749025, -0.9890345259042298, -0.9732963160677508};
  EXPECT_LT(std::sqrt(closest_point(known, above).squared_distance), 4e-15);
  Random random(12);
  for (int trial = 0; trial < 60'000; ++trial) {
    const double size = std::pow(10.0, random.uniform(-13, 0)), flat = std::pow(10.0, random.uniform(-4, 0));
    const Vec3 a = test::random_point(random, 1), b = a + test::random_point(random, size);
    const Vec3 c = a + (a - b) * random.uniform(0, 1) + test::random_point(random, size * flat);
    const std::array<Vec3, 3> corners{a, b, c};
    const auto first = static_cast<std::size_t>(trial % 3);
    const Triangle t{corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]};
    const double u = random.uniform(0, 1), v = trial % 2 == 0 ? 0 : random.uniform(0, 1 - u);
    const Vec3 place = at_barycentric(t, {1 - u - v, u, v});
    const Vec3 p = place + test::random_point(random, std::pow(10.0, random.uniform(-17, -12)));
    ASSERT_LE(std::sqrt(closest_point(t, p).squared_distance), distance(p, place) + 0x1p-50)
        << "trial " << trial << ", size " << size << ", flat " << flat;
  }
}

TEST(Triangle, closest_point_on_corners_and_edges_has_zero_coordinates) {
  const Triangle t{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}};
  EXPECT_EQ(closest_point(t, {-1, -1, 2}).barycentric, (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(closest_point(t, {0.25, -3, 1}).barycentric, (std::array<double, 3>{0.75, 0.25, 0}));
  EXPECT_EQ(closest_point(t, {0.25, 0.25, 5}).point, (Vec3{0.25, 0.25, 0}));
}

TEST(Triangle, solid_angles_of_a_closed_box_add_up_to_a_full_sphere_inside_and_nothing_outside) {
  const std::array<Vec3, 8> v{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0},
                              Vec3{0, 0, 1}, Vec3{1, 0, 1}, Vec3{1, 1, 1}, Vec3{0, 1, 1}};
  constexpr int facets[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                                 {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  const auto sum = [&](const Vec3& p) {
    double total = 0;
    for (const auto& f : facets) total += solid_angle({v[f[0]], v[f[1]], v[f[2]]}, p);
    return total;
  };
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    EXPECT_NEAR(sum({random.uniform(0.01, 0.99), random.uniform(0.01, 0.99), random.uniform(0.01, 0.99)}),
                4 * std::numbers::pi, 1e-10);
    EXPECT_NEAR(sum({random.uniform(1.01, 3), random.uniform(-2, 2), random.uniform(-2, 2)}), 0, 1e-10);
  }
}

TEST(Triangle, solid_angle_of_an_octant_is_a_half_pi) {
  const Triangle t{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  EXPECT_NEAR(solid_angle(t, {0, 0, 0}), std::numbers::pi / 2, 1e-15);
  EXPECT_EQ(solid_angle({t[0], t[0], t[2]}, {0, 0, 0}), 0);
}

}  // namespace
}  // namespace morula
