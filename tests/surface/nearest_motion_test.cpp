// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The nearest motion that half spaces permit, by the conditions of an optimum.
#include "surface/haptic/nearest_motion.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <vector>

namespace morula {
namespace {

using detail::KeptMotions;
using detail::Motion;

double product(const Motion& a, const Motion& b) {
  double sum = 0;
  for (std::size_t i = 0; i < 6; ++i) sum += a[i] * b[i];
  return sum;
}

Motion random_motion(Random& random, double reach) {
  Motion m{};
  for (double& x : m) x = random.uniform(-reach, reach);
  return m;
}

TEST(NearestMotion, has_the_conditions_of_an_optimum) {
  // The conditions of Karush, Kuhn and Tucker are necessary and sufficient here.
  Random random(21);
  std::array<int, 7> active{};
  for (int round = 0; round < 5000; ++round) {
    std::vector<KeptMotions> sides;
    const Motion inside = random_motion(random, 1);
    const int count = static_cast<int>(random.uniform(1, 40));
    for (int k = 0; k < count; ++k) {
      const Motion row = random_motion(random, k % 3 == 0 ? 0.1 : 1);
      sides.push_back({row, product(row, inside) - random.uniform(0, 0.3)});
    }
    if (round % 4 == 0) sides.push_back(sides[0]);  // twice, and a sum of two
    if (round % 8 == 0 && count > 1) {
      KeptMotions both = sides[0];
      for (std::size_t i = 0; i < 6; ++i) both.row[i] += sides[1].row[i];
      both.offset += sides[1].offset;
      sides.push_back(both);
    }
    const Motion goal = random_motion(random, 3);
    const detail::NearestMotion found = detail::nearest_motion(goal, sides, 1e-9);
    ASSERT_TRUE(found.exists) << round;
    Motion sum = goal;
    for (std::size_t k = 0; k < found.active_count; ++k) {
      const KeptMotions& side = sides[found.active[k]];
      EXPECT_GE(found.weight[k], 0);
      EXPECT_NEAR(product(side.row, found.motion), side.offset, 1e-7);
      for (std::size_t i = 0; i < 6; ++i) sum[i] += found.weight[k] * side.row[i];
    }
    for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(sum[i], found.motion[i], 1e-7) << round;
    for (const KeptMotions& side : sides) EXPECT_GE(product(side.row, found.motion), side.offset - 1e-8) << round;
    ++active[found.active_count];
  }
  for (const int count : active) EXPECT_GT(count, 20);
}

TEST(NearestMotion, does_not_exist_between_half_spaces_that_have_no_common_motion) {
  const std::vector<KeptMotions> apart{{{0, 0, 1, 0, 0, 0}, 1}, {{0, 0, -1, 0, 0, 0}, 1}};
  EXPECT_FALSE(detail::nearest_motion({}, apart, 1e-9).exists);
  // Three normals of a triangle that point out of it, with lever arms.
  std::vector<KeptMotions> sides;
  for (int k = 0; k < 3; ++k) {
    const double angle = 2.0943951023931953 * k;
    sides.push_back({{std::cos(angle), std::sin(angle), 0, 0, 0, 0}, 0.1});
  }
  EXPECT_FALSE(detail::nearest_motion({1, 2, 3, 4, 5, 6}, sides, 1e-9).exists);
}

}  // namespace
}  // namespace morula
