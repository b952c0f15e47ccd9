// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The oracle's triangles: cases worked out by hand, and the library's exact verdict, which was made another way.
#include <gtest/gtest.h>

#include <dice.hpp>
#include <morula/geometry/triangle_intersection.hpp>
#include <triangles.hpp>
#include <tuple>

namespace oracle {
namespace {

constexpr LatticeTriangle flat{LatticePoint{0, 0, 0}, LatticePoint{4, 0, 0}, LatticePoint{0, 4, 0}};

TEST(OracleTriangles, decide_what_can_be_seen) {
  const auto meets = [](const LatticeTriangle& t) { return meet_exactly(flat, t) && meet_exactly(t, flat); };
  EXPECT_TRUE(meets({LatticePoint{1, 1, -1}, {1, 1, 1}, {5, 5, 0}})) << "through its inside";
  EXPECT_TRUE(meets({LatticePoint{4, 0, 0}, {5, 0, 1}, {5, 1, 0}})) << "one corner in common";
  EXPECT_TRUE(meets({LatticePoint{2, 2, 0}, {5, 5, 1}, {5, 5, 0}})) << "a corner on an edge";
  EXPECT_TRUE(meets({LatticePoint{1, 1, 0}, {2, 1, 0}, {1, 2, 0}})) << "inside, in one plane";
  EXPECT_TRUE(meets({LatticePoint{-1, -1, 0}, {9, -1, 0}, {-1, 9, 0}})) << "around it, in one plane";
  EXPECT_TRUE(meets({LatticePoint{1, 1, 0}, {1, 1, 0}, {1, 1, 0}})) << "a point";
  EXPECT_TRUE(meets({LatticePoint{-1, 1, 0}, {9, 1, 0}, {-1, 1, 0}})) << "a segment in its plane";
  EXPECT_FALSE(meets({LatticePoint{3, 3, 0}, {5, 3, 0}, {3, 5, 0}})) << "beside it, in one plane";
  EXPECT_FALSE(meets({LatticePoint{3, 2, -1}, {3, 2, 1}, {3, 2, 1}})) << "a segment past its edge";
  EXPECT_FALSE(meets({LatticePoint{3, 2, 0}, {3, 2, 0}, {3, 2, 0}})) << "a point past its edge";
  EXPECT_FALSE(meets({LatticePoint{5, 0, 0}, {9, 0, 0}, {7, 0, 0}})) << "a segment in line with its edge";
  EXPECT_FALSE(meets({LatticePoint{0, 0, 1}, {4, 0, 1}, {0, 4, 1}})) << "above it";
}

TEST(OracleTriangles, agree_with_the_exact_verdict_of_the_library) {
  Dice dice(5);
  std::size_t meeting = 0;
  constexpr int count = 30000;
  for (int n = 0; n < count; ++n) {
    const std::size_t side = dice.pick<std::size_t>({2, 3, 4, 8, 1u << 20});
    LatticeTriangle a, b;
    morula::Triangle c, d;
    Triangle e, f;
    for (std::size_t k = 0; k < 3; ++k)
      for (auto [whole, doubles, reals] : {std::tuple(&a, &c, &e), std::tuple(&b, &d, &f)}) {
        const auto x = static_cast<std::int64_t>(dice.below(side + 1)),
                   y = static_cast<std::int64_t>(dice.below(side + 1)),
                   z = static_cast<std::int64_t>(dice.below(side + 1));
        (*whole)[k] = {x, y, z};
        const morula::Vec3 p{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
        (*doubles)[k] = p;
        (*reals)[k] = {p.x, p.y, p.z};
      }
    const bool met = meet_exactly(a, b);
    meeting += met;
    ASSERT_EQ(met, morula::intersect(c, d)) << n;
    if (clearly_apart(e, f, 1e-9L)) {
      ASSERT_FALSE(met) << n;
    }
    if (clearly_crossing(e, f, 1e-6L)) {
      ASSERT_TRUE(met) << n;
    }
    if (side <= 8 && !met) {
      ASSERT_TRUE(clearly_apart(e, f, 1e-9L)) << n << ": the gap of so coarse a lattice is wide";
    }
  }
  EXPECT_GT(meeting, count / 5u);
  EXPECT_LT(meeting, count * 4u / 5u);
}

TEST(OracleTriangles, cross_clearly_where_the_point_is) {
  const Triangle t{Point{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto at = clearly_crossing(t, {Point{1, 1, -1}, {1, 1, 1}, {9, 9, 0}}, 0.5L);
  ASSERT_TRUE(at);
  EXPECT_EQ(distance(*at, {1, 1, 0}), 0);
  EXPECT_FALSE(clearly_crossing(t, {Point{1, 1, -1}, {1, 1, 1}, {9, 9, 0}}, 1.0L)) << "within the margin of an end";
  EXPECT_FALSE(clearly_crossing(t, {Point{2, 2, -1}, {2, 2, 1}, {9, 9, 0}}, 0.1L)) << "on an edge";
}

}  // namespace
}  // namespace oracle
