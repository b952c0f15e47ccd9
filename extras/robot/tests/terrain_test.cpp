// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Height fields of a world, compared with all of their triangles and walls one by one.
#include <gtest/gtest.h>

#include "random_poses.hpp"
#include "terrain_distance.hpp"

namespace morula::test::terrain {
namespace {

using Wide = TerrainDistance::Point;

TEST(Terrain, nearest_places_are_those_of_all_triangles_and_walls) {
  Random random(51);
  std::size_t inside = 0, beside = 0, compared = 0, directions = 0;
  for (int k = 0; k < 60; ++k) {
    const double scale = std::array{1.0, 1e-6, 1e4}[static_cast<std::size_t>(k) % 3];
    robot::HeightField field{.columns = 2 + random.next() % 5, .rows = 2 + random.next() % 5, .spacing = 0.3 * scale};
    // Flat ones and steep ones.
    const double height = std::array{0.0, 0.2, 2.0}[random.next() % 3] * scale;
    std::vector<double> heights;
    for (std::size_t i = 0; i < field.columns * field.rows; ++i) heights.push_back(random.uniform(-height, height));
    field.heights = heights;
    field.pose = k % 4 == 0 ? RigidTransform{} : random_pose(random, 3 * scale);
    robot::World world;
    world.add(field);
    const TerrainDistance exact(field);
    const auto along = [&](std::size_t count) {
      const double end = static_cast<double>(count - 1) * field.spacing;
      return random.uniform(-0.5 * scale, end + 0.5 * scale);
    };
    for (int i = 0; i < 200; ++i) {
      const Vec3 local{along(field.columns), along(field.rows), random.uniform(-2.5, 2.5) * scale};
      const Vec3 p = field.pose(local);
      const Wide wide{p.x, p.y, p.z};
      const long double distance = exact(wide);
      const robot::NearestObstacle found = world.nearest(p);
      ASSERT_NEAR(found.distance, static_cast<double>(distance), 1e-13 * scale) << k << " " << i;
      ++compared, inside += distance < 0;
      beside += local.x < 0 || local.y < 0;
      const double limit = random.uniform(-1, 1) * scale;
      EXPECT_EQ(world.nearest(p, limit).obstacle, found.distance <= limit ? 0 : robot::none);
      // Along the direction the distance grows as fast as it can, except on ridges.
      const long double step = 1e-6L * scale;
      const auto moved = [&](long double by) {
        const Vec3& d = found.direction;
        return exact({wide[0] + by * d.x, wide[1] + by * d.y, wide[2] + by * d.z});
      };
      const long double up = moved(step) - distance, down = distance - moved(-step);
      if (std::abs(up - down) > 1e-3L * step || std::abs(distance) < 10 * step) continue;
      EXPECT_NEAR(static_cast<double>(up / step), 1, 1e-3) << k << " " << i;
      ++directions;
    }
  }
  EXPECT_GT(inside, compared / 12);
  EXPECT_GT(compared - inside, compared / 5);
  EXPECT_GT(beside, compared / 10);
  EXPECT_GT(directions, compared / 2);
}

}  // namespace
}  // namespace morula::test::terrain
