// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signs of determinants against whole numbers wide enough to be exact.
#include "collide/orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/random.hpp>

#include "collide/nearest_pair.hpp"
#include "placed_bodies.hpp"

namespace morula {
namespace {

__extension__ using Wide = __int128;

int sign_of(Wide x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}
// Whole numbers below 2^30: what is subtracted needs 31 bits, a product of three 93.
Wide whole(double x) {
  return static_cast<Wide>(static_cast<std::int64_t>(x));
}

int exact_height(const Triangle& t, const Vec3& p) {
  Wide d[3][3];
  const Vec3 points[3]{t[1], t[2], p};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) d[i][k] = whole(points[i][k]) - whole(t[0][k]);
  return sign_of(d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
                 d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]));
}

Vec3 whole_point(Random& random, double reach) {
  const Vec3 p = test::random_point(random, reach);
  return {std::round(p.x), std::round(p.y), std::round(p.z)};
}

TEST(Orientation, of_planes_is_exact_on_and_next_to_them) {
  Random random(3);
  int zeros = 0, signs = 0;
  for (int round = 0; round < 20000; ++round) {
    const double reach = round % 2 == 0 ? 0x1p29 : 4.0;
    Triangle t{whole_point(random, reach), whole_point(random, reach), whole_point(random, reach)};
    Vec3 p = whole_point(random, reach);
    if (round % 4 == 0) {
      // In the plane, or a unit beside it.
      t[0] = whole_point(random, 0x1p26), t[1] = whole_point(random, 0x1p26), t[2] = whole_point(random, 0x1p26);
      p = t[0] + (t[1] - t[0]) * std::round(random.uniform(-3, 3)) + (t[2] - t[0]) * std::round(random.uniform(-3, 3));
      if (round % 8 == 0) p.x += random.uniform() < 0.5 ? 1 : -1;
    }
    const int expected = exact_height(t, p);
    ASSERT_EQ(orientation(t, p), expected) << round;
    ++(expected == 0 ? zeros : signs);
    // A power of two changes no sign: the same with all bits elsewhere.
    const auto moved = [](const Vec3& v) { return v * 0x1p-60; };
    ASSERT_EQ(orientation({moved(t[0]), moved(t[1]), moved(t[2])}, moved(p)), expected);
  }
  EXPECT_GT(zeros, 2000);
  EXPECT_GT(signs, 10000);
}

TEST(Orientation, of_lines_and_products_is_exact) {
  Random random(4);
  int zeros = 0;
  for (int round = 0; round < 20000; ++round) {
    const Vec3 a = whole_point(random, round % 2 == 0 ? 0x1p28 : 5),
               b = whole_point(random, round % 2 == 0 ? 0x1p28 : 5);
    Vec3 p = a + (b - a) * std::round(random.uniform(-2, 2));
    if (round % 3 == 0) p.y += 1;
    const Wide det =
        (whole(a.x) - whole(p.x)) * (whole(b.y) - whole(p.y)) - (whole(a.y) - whole(p.y)) * (whole(b.x) - whole(p.x));
    ASSERT_EQ(orientation(a.x, a.y, b.x, b.y, p.x, p.y), sign_of(det)) << round;
    zeros += det == 0;
    const double m = std::round(random.uniform(0, 0x1p53)), n = std::round(random.uniform(0, 0x1p53));
    const double k = m + std::round(random.uniform(-2, 2)), l = n + std::round(random.uniform(-2, 2));
    ASSERT_EQ(sign_of_difference(m, n, k, l), sign_of(whole(m) * whole(n) - whole(k) * whole(l)));
  }
  EXPECT_GT(zeros, 5000);
}

// Slivers, needles, parallel and nearly touching pairs: the bounds may part, but both must hold.
TEST(NearestPair, bounds_hold_for_hard_triangles) {
  Random random(17);
  for (int round = 0; round < 20000; ++round) {
    Triangle a, b;
    for (Vec3& p : a) p = test::random_point(random, 1.0);
    for (Vec3& p : b) p = test::random_point(random, 1.0);
    if (round % 3 == 0) a[2] = a[0] + (a[1] - a[0]) * random.uniform() + test::random_point(random, 1e-7);
    if (round % 4 == 0)
      for (std::size_t k = 0; k < 3; ++k) b[k] = a[k] + Vec3{0, 0, 1e-6} + test::random_point(random, 1e-9);
    if (round % 5 == 0) b[1] = b[0];
    if (round % 7 == 0) b[0] = a[1] + test::random_point(random, 1e-8);
    const Vec3 about = round % 6 == 0 ? Vec3{1e5, -1e5, 1e5} : Vec3{};
    for (Vec3& p : a) p += about;
    for (Vec3& p : b) p += about;
    const double slack = 1e-14 * (1 + largest_component(about));
    const double expected = test::slow_distance(a, b);
    const NearestPair found = nearest_pair(a, b);
    ASSERT_LE(found.lower, found.upper) << round;
    // The slow way may itself be off where a pierces b next to an edge; a crossing found exactly is no fault.
    ASSERT_LE(found.lower, expected + slack) << round;
    if (!found.crossing) {
      ASSERT_LE(found.upper, expected + 8 * slack + 1e-7 * (expected == 0)) << round;
      // The slow way loses a little among nearly parallel edges. The points prove themselves.
      ASSERT_GE(found.upper, distance(found.point_a, found.point_b)) << round;
      ASSERT_LE(distance(at_barycentric(a, found.a), found.point_a), slack) << round;
      ASSERT_LE(distance(at_barycentric(b, found.b), found.point_b), slack) << round;
    }
    const NearestPair other = nearest_pair(b, a);
    EXPECT_EQ(other.crossing, found.crossing) << round;
    EXPECT_LE(other.lower, found.upper) << round;
    EXPECT_LE(found.lower, other.upper) << round;
  }
}

}  // namespace
}  // namespace morula
