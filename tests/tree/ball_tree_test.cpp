// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <stdexcept>
#include <tuple>

namespace morula::test {
namespace {

std::vector<Sphere> random_balls(std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const auto number = [&] { return static_cast<double>(random.next() >> 11) * 0x1p-53; };
  std::vector<Sphere> balls(count);
  for (Sphere& s : balls) s = {{10 * number(), number(), number() - 1000}, 0.1 * number()};
  return balls;
}

std::vector<std::tuple<double, double, double, double>> sorted(const std::vector<Sphere>& balls) {
  std::vector<std::tuple<double, double, double, double>> list;
  for (const Sphere& s : balls) list.emplace_back(s.center.x, s.center.y, s.center.z, s.radius);
  std::sort(list.begin(), list.end());
  return list;
}

TEST(BallTree, has_the_balls_as_leaves_and_nodes_that_contain_them) {
  for (const std::size_t count : {1u, 2u, 7u, 8u, 9u, 64u, 65u, 1000u})
    for (const std::uint32_t branching : {2u, 8u, 64u}) {
      if (count > 256 && branching == 2) continue;
      const std::vector<Sphere> balls = random_balls(count, count);
      const SphereTree tree = tree_from_spheres(balls, branching);
      EXPECT_TRUE(validate(tree).empty()) << count << ' ' << branching;
      EXPECT_EQ(tree.branching, branching);
      EXPECT_EQ(sorted(level_set_spheres(tree, tree.level_count() - 1)), sorted(balls));
      // In long double, from each leaf up to the root.
      for (std::uint32_t leaf = 0; leaf < tree.node_count(); ++leaf) {
        if (!tree.is_leaf(leaf)) continue;
        const Sphere& ball = tree.spheres[leaf];
        for (std::uint32_t node = tree.parent[leaf]; node != no_node; node = tree.parent[node]) {
          const Sphere& outer = tree.spheres[node];
          long double squared = 0;
          for (int axis = 0; axis < 3; ++axis) {
            const long double d = static_cast<long double>(ball.center[axis]) - outer.center[axis];
            squared += d * d;
          }
          EXPECT_LE(std::sqrt(squared) + ball.radius, static_cast<long double>(outer.radius));
        }
      }
    }
}

TEST(BallTree, equal_balls_are_no_trouble_and_the_order_does_not_matter_to_the_root) {
  const std::vector<Sphere> equal(100, Sphere{{1, 2, 3}, 4});
  const SphereTree tree = tree_from_spheres(equal);
  EXPECT_TRUE(validate(tree).empty());
  EXPECT_EQ(tree.leaf_count(), 100u);
  EXPECT_NEAR(tree.spheres[0].radius, 4, 1e-9);
}

TEST(BallTree, what_has_no_tree_is_refused) {
  EXPECT_THROW(tree_from_spheres({}), std::invalid_argument);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(tree_from_spheres(std::vector<Sphere>{{{0, 0, infinity}, 1}}), std::invalid_argument);
  EXPECT_THROW(tree_from_spheres(std::vector<Sphere>{{{0, 0, 0}, -1}}), std::invalid_argument);
  EXPECT_THROW(tree_from_spheres(std::vector<Sphere>{{{-1.7e308, -1.7e308, 0}, 1}, {{1.7e308, 1.7e308, 0}, 1}}),
               std::invalid_argument);
  EXPECT_THROW(tree_from_spheres(random_balls(300, 1), 2), std::invalid_argument) << "eight levels hold 256";
  EXPECT_THROW(tree_from_spheres(random_balls(3, 1), 65), std::invalid_argument);
}

}  // namespace
}  // namespace morula::test
