// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signs against determinants in integers of 128 bits.
#include "geometry/exact_predicates.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <support/transforms.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

__extension__ typedef __int128 Integer;

int sign_of(Integer x) {
  return x > 0 ? 1 : x < 0 ? -1 : 0;
}
Integer whole(double x) {
  return static_cast<Integer>(static_cast<std::int64_t>(x));
}

int integer_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Integer m[3][3];
  const Vec3* const rows[3] = {&b, &c, &d};
  for (int row = 0; row < 3; ++row)
    for (int axis = 0; axis < 3; ++axis) m[row][axis] = whole((*rows[row])[axis]) - whole(a[axis]);
  return sign_of(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                 m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}
int integer_orient2d(const Vec3& a, const Vec3& b, const Vec3& c, Projection p) {
  const int i = p.first, j = p.second;
  return sign_of((whole(b[i]) - whole(a[i])) * (whole(c[j]) - whole(a[j])) -
                 (whole(b[j]) - whole(a[j])) * (whole(c[i]) - whole(a[i])));
}

// Nearly in the plane of three others, in integers below 2^40.
Vec3 random_near_plane(Random& random, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double v = random.uniform(-1, 1), w = random.uniform(-1, 1);
  const Vec3 p = a + (b - a) * v + (c - a) * w;
  return {std::round(p.x), std::round(p.y), std::round(p.z)};
}

TEST(ExactPredicates, agree_with_integers_on_grids_and_close_to_planes_at_any_scale) {
  Random random(1);
  constexpr double scales[] = {1.0, 0x1p-1074, 0x1p-700, 0x1p-340, 0x1p-37, 0x1p300, 0x1p400, 0x1p980};
  std::size_t zeros = 0, exact = 0;
  for (int round = 0; round < 60000; ++round) {
    const double most = round % 3 == 0 ? 3 : round % 3 == 1 ? 0x1p20 : 0x1p38;
    const Vec3 a = test::random_whole(random, most), b = test::random_whole(random, most),
               c = test::random_whole(random, most);
    const Vec3 d = round % 2 == 0 ? test::random_whole(random, most) : random_near_plane(random, a, b, c);
    const int expected = integer_orient3d(a, b, c, d);
    zeros += expected == 0;
    const double s = scales[static_cast<std::size_t>(round / 7) % std::size(scales)];
    ASSERT_EQ(orient3d(a * s, b * s, c * s, d * s), expected) << "scale " << s;
    const Triangle t{a * s, b * s, c * s};
    const TrianglePlane::Side side = TrianglePlane(t).side(d * s);
    ASSERT_EQ(side.sign, expected);
    ASSERT_GE(side.value * side.sign, 0);
    exact += side.value == 0;
    for (const Projection projection : projections) {
      const Vec3 e = round % 4 == 1 ? a + (b - a) * 2.0 : d;
      if (max_norm(e) > 0x1p40) continue;
      ASSERT_EQ(orient2d(a * s, b * s, e * s, projection), integer_orient2d(a, b, e, projection)) << "scale " << s;
    }
  }
  EXPECT_GT(zeros, 1000u);
  EXPECT_GT(exact, zeros);
}

TEST(ExactPredicates, see_the_last_bit_beside_the_largest_number) {
  constexpr double huge = 0x1p1023, tiny = std::numeric_limits<double>::denorm_min();
  const Vec3 o{0, 0, 0}, x{huge, 0, 0}, y{0, huge, 0};
  EXPECT_EQ(orient3d(o, x, y, {huge, -huge, tiny}), 1);
  EXPECT_EQ(orient3d(o, x, y, {huge, -huge, 0}), 0);
  EXPECT_EQ(orient3d(o, x, y, {huge, -huge, -tiny}), -1);
  EXPECT_EQ(orient3d({0, 0, tiny}, {huge, 0, tiny}, {0, huge, tiny}, {-huge, -huge, tiny}), 0);
  EXPECT_EQ(orient3d({0, 0, tiny}, {huge, 0, tiny}, {0, huge, tiny}, {-huge, -huge, 0}), -1);
  EXPECT_EQ(orient2d({-huge, 0, 0}, {huge, 0, 0}, {huge, tiny, 0}, projections[2]), 1);
  EXPECT_EQ(orient2d({-huge, -huge, 0}, {huge, huge, 0}, {tiny, 0, 0}, projections[2]), -1);
  EXPECT_EQ(orient2d({-huge, -huge, 0}, {huge, huge, 0}, {1e-300, 1e-300, 0}, projections[2]), 0);
}

// Where doubles by themselves give wrong signs, off by more than half of what the filters allow for:
// points beside the line or plane x = y, by as little as one half and its neighbors differ. Also so small that
// products vanish. What is right hangs on x and y alone.
TEST(ExactPredicates, are_right_where_doubles_are_wrong) {
  const std::vector<Vec3> on_plane{{12, 12, 1}, {24, 24, 5}, {7.3, 7.3, 30}, {-3.1, -3.1, 11}, {17.7, 17.7, -9}};
  const Vec3 beside{1, 0, 0.5};
  for (const double s : {1.0, 0x1p-345, 0x1p-347, 0x1p-349, 0x1p-515, 0x1p-517, 0x1p-519})
    for (const Vec3& b : on_plane)
      for (const Vec3& c : on_plane) {
        if (b == c) continue;
        const int turn = orient2d(beside, b, c, projections[2]);
        for (int i = 0; i < 24; ++i)
          for (int j = 0; j < 24; ++j) {
            const Vec3 a = Vec3{0.5 + i * 0x1p-53, 0.5 + j * 0x1p-53, 0.5} * s;
            const int side = i > j ? 1 : i < j ? -1 : 0;
            ASSERT_EQ(orient2d(a, b * s, c * s, projections[2]), side * turn) << s;
            ASSERT_EQ(orient2d(b * s, c * s, a, projections[2]), side * turn) << s;
            ASSERT_EQ(orient2d(c * s, a, b * s, projections[2]), side * turn) << s;
            if (s < 0x1p-400 || (i + j) % 3 != 0) continue;
            for (const Vec3& d : on_plane) {
              if (d == b || d == c) continue;
              const int up = orient3d(beside, b, c, d);
              ASSERT_EQ(orient3d(a, b * s, c * s, d * s), side * up) << s;
              ASSERT_EQ(orient3d(b * s, c * s, d * s, a), -side * up) << s;
              ASSERT_EQ(orient3d(d * s, a, b * s, c * s), -side * up) << s;
            }
          }
      }
}

// Coordinates of all magnitudes at once: no oracle holds them, but swapping two points has to turn the sign.
TEST(ExactPredicates, turn_their_sign_when_points_swap) {
  Random random(2);
  std::size_t signs[3] = {};
  for (int round = 0; round < 20000; ++round) {
    const auto coordinate = [&] {
      if (random.uniform() < 0.2) return 0.0;
      return std::ldexp(random.uniform(-1, 1), static_cast<int>(random.uniform(-1070, 1020)));
    };
    Vec3 p[4];
    for (Vec3& v : p) v.x = coordinate(), v.y = coordinate(), v.z = coordinate();
    if (round % 5 == 0) p[3] = p[static_cast<std::size_t>(round / 5) % 3];
    const int sign = orient3d(p[0], p[1], p[2], p[3]);
    ++signs[sign + 1];
    ASSERT_EQ(orient3d(p[1], p[0], p[2], p[3]), -sign);
    ASSERT_EQ(orient3d(p[0], p[2], p[1], p[3]), -sign);
    ASSERT_EQ(orient3d(p[0], p[1], p[3], p[2]), -sign);
    ASSERT_EQ(orient3d(p[3], p[1], p[2], p[0]), -sign);
    const int turn = orient2d(p[0], p[1], p[2], projections[0]);
    ASSERT_EQ(orient2d(p[1], p[2], p[0], projections[0]), turn);
    ASSERT_EQ(orient2d(p[1], p[0], p[2], projections[0]), -turn);
  }
  for (const std::size_t count : signs) EXPECT_GT(count, 1000u);
}

}  // namespace
}  // namespace morula
