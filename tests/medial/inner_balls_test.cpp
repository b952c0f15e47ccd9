// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Which balls fill most. Those inside meshes are tested with clumps and robots.
#include <gtest/gtest.h>

#include <limits>
#include <morula/medial/medial_balls.hpp>
#include <vector>

namespace morula {
namespace {

TEST(FullestBalls, are_taken_in_the_order_of_what_they_add) {
  const Sphere large{{0, 0, 0}, 2}, inside_of_it{{0.5, 0, 0}, 1}, small{{5, 0, 0}, 0.5}, middle{{-5, 0, 0}, 1};
  const std::vector<Sphere> balls{small, inside_of_it, large, middle};
  EXPECT_EQ(fullest_balls(balls, 2), (std::vector<Sphere>{large, middle}));
  EXPECT_EQ(fullest_balls(balls, 9), (std::vector<Sphere>{large, middle, small}));
  EXPECT_TRUE(fullest_balls(balls, 0).empty());
  EXPECT_TRUE(fullest_balls({}, 3).empty());
}

// Where coordinates cannot tell the balls' box from a point, or it is not finite, there is no lattice to count on.
TEST(FullestBalls, without_a_lattice_are_the_largest_one) {
  constexpr double greatest = std::numeric_limits<double>::max();
  for (const std::vector<Sphere>& balls :
       {std::vector<Sphere>{{{1e6, 0, 0}, 1e-12}, {{1e6, 0, 0}, 2e-12}}, std::vector<Sphere>{{{1, 2, 3}, 0}},
        std::vector<Sphere>{{{0, 0, 0}, 1}, {{0, 0, 0}, greatest}}}) {
    EXPECT_EQ(fullest_balls(balls, 3), std::vector<Sphere>{balls.back()});
    EXPECT_TRUE(fullest_balls(balls, 0).empty());
  }
}

}  // namespace
}  // namespace morula
