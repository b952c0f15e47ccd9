// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The nearest point on the kept sides of planes, by the conditions of an optimum.
#include "surface/haptic/half_spaces.hpp"

#include <gtest/gtest.h>

#include <array>
#include <support/transforms.hpp>
#include <vector>

namespace morula {
namespace {

TEST(HalfSpaces, have_a_nearest_point_with_the_conditions_of_an_optimum) {
  // The conditions of Karush, Kuhn and Tucker are necessary and sufficient here.
  Random random(17);
  std::array<int, 4> active{};
  for (int round = 0; round < 5000; ++round) {
    std::vector<detail::KeptSide> sides;
    const Vec3 inside = test::random_point(random, 1);
    const std::size_t count = static_cast<std::size_t>(random.uniform(1, 9));
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3 normal = normalized(test::random_point(random, 1));
      sides.push_back({normal, dot(normal, inside) - random.uniform(0, 0.3)});
    }
    if (round % 4 == 0) sides.push_back(sides[0]);
    const Vec3 goal = test::random_point(random, 3);
    const detail::NearestKept found = detail::nearest_kept(goal, sides, 1e-9);
    ASSERT_TRUE(found.exists) << round;
    Vec3 sum = goal;
    for (std::size_t k = 0; k < found.active_count; ++k) {
      const detail::KeptSide& side = sides[found.active[k]];
      EXPECT_GE(found.weight[k], 0);
      EXPECT_NEAR(dot(side.normal, found.point), side.offset, 1e-8);
      sum += found.weight[k] * side.normal;
    }
    EXPECT_LT(distance(sum, found.point), 1e-9 * (1 + length(goal - found.point))) << round;
    for (const detail::KeptSide& side : sides) EXPECT_GE(dot(side.normal, found.point), side.offset - 1e-8) << round;
    ++active[found.active_count];
  }
  for (const int count : active) EXPECT_GT(count, 50);
  const std::vector<detail::KeptSide> apart{{{0, 0, 1}, 1}, {{0, 0, -1}, 1}};
  EXPECT_FALSE(detail::nearest_kept({}, apart, 1e-9).exists);
}

}  // namespace
}  // namespace morula
