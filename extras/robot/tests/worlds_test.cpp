// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Worlds of obstacles: the nearest one, meshes and terrain, against formulas and closed meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/signed_distance.hpp>
#include <morula/robot/configurations.hpp>

#include "obstacle_scenes.hpp"
#include "random_poses.hpp"

namespace morula::test::configurations {
namespace {

using robot::ConfigurationQuery;
using robot::ConfigurationVerdict;

TEST(Worlds, CopiesKeepWhatTheyHave) {
  World first;
  first.add(Sphere{{}, 1});
  World second = first;
  EXPECT_EQ(second.add(Sphere{{9, 0, 0}, 1}), 1u);
  EXPECT_EQ(first.size(), 1u);
  EXPECT_EQ(second.nearest({8, 0, 0}).obstacle, 1u);
  World moved = std::move(second);
  EXPECT_EQ(moved.size(), 2u);
  // A world that was moved from is empty, also where the other one was not.
  World third = first;
  third = std::move(moved);
  EXPECT_EQ(third.size(), 2u);
  EXPECT_EQ(moved.size(), 0u);  // NOLINT(bugprone-use-after-move)
}

TEST(Worlds, FindTheNearestObstacle) {
  Random random(5);
  const Scene scene(random, {}, 1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = random_point(random, 2);
    double least = 1e300;
    for (const Distance& distance : scene.distances) least = std::min(least, distance(p));
    const robot::NearestObstacle found = scene.world.nearest(p);
    ASSERT_NEAR(found.distance, least, 1e-9);
    EXPECT_NEAR(scene.distances[found.obstacle](p), least, 1e-9);
    EXPECT_NEAR(length(found.direction), 1, 1e-9);
    // Along the direction the distance of that obstacle grows.
    EXPECT_NEAR(scene.distances[found.obstacle](p + 1e-6 * found.direction), least + 1e-6, 2e-7) << found.obstacle;
    EXPECT_EQ(scene.world.nearest(p, least + 1e-6).obstacle, found.obstacle);
    EXPECT_EQ(scene.world.nearest(p, least - 1e-6).obstacle, robot::none);
  }
}

TEST(Worlds, MeshesTouchWhereTheirDistanceSays) {
  Random random(8);
  for (const double size : {1.0, 1e-9, 1e9}) {
    const Vec3 half{0.5 * size, 0.3 * size, 0.1 * size};
    const ObstacleBox box{{}, half};
    World world;
    world.add(centered_box(half));
    Slider slider;
    for (int i = 0; i < 600; ++i) {
      const Vec3 p = random_point(random, 0.55 * size);
      const double exact = box_distance(box, p), gap = (i % 2 == 0 ? 1e-7 : -1e-7) * size;
      if (exact <= gap) continue;
      slider.robot.joints[0].origin.translation = {0, p.y, p.z};
      slider.spheres.links[0].spheres[0].radius = exact - gap;
      ConfigurationVerdict verdict;
      ConfigurationQuery(slider.robot, slider.spheres).check(std::span(&p.x, 1), world, std::span(&verdict, 1));
      EXPECT_EQ(verdict.is_free(), gap > 0);
    }
  }
}

// A triangle and the same one reversed: closed and oriented, without a volume.
TEST(Worlds, FlatMeshesHaveNoInside) {
  Random random(13);
  for (int k = 0; k < 100; ++k) {
    Mesh mesh;
    for (int i = 0; i < 3; ++i) mesh.positions.push_back(random_point(random, 1));
    mesh.facets = {{0, 1, 2}};
    World single, twice;
    single.add(mesh);
    mesh.facets.push_back({0, 2, 1});
    twice.add(mesh);
    for (int i = 0; i < 20; ++i) {
      const Vec3 p = random_point(random, 1);
      EXPECT_NEAR(twice.nearest(p).distance, single.nearest(p).distance, 1e-12);
    }
  }
}

TEST(Worlds, TerrainIsTheSolidBelowItsSurface) {
  // The same solid as a closed mesh with a deep floor.
  Random random(6);
  constexpr std::uint32_t columns = 5, rows = 4;
  std::vector<double> heights;
  for (std::uint32_t i = 0; i < columns * rows; ++i) heights.push_back(random.uniform(-0.5, 0.5));
  Mesh solid;
  for (const bool is_floor : {false, true}) {
    for (std::uint32_t i = 0; i < columns * rows; ++i)
      solid.positions.push_back({0.5 * (i % columns), 0.5 * (i / columns), is_floor ? -100 : heights[i]});
  }
  const std::uint32_t floor = columns * rows;
  for (std::uint32_t k = 0; k + 1 < rows; ++k) {
    for (std::uint32_t i = 0; i + 1 < columns; ++i) {
      const std::uint32_t a = k * columns + i, b = a + 1, c = b + columns, d = a + columns;
      for (const Facet& f : {Facet{a, b, c}, Facet{a, c, d}}) {
        solid.facets.push_back(f);
        solid.facets.push_back({f[2] + floor, f[1] + floor, f[0] + floor});
      }
    }
  }
  const auto wall = [&](std::uint32_t from, std::uint32_t to) {
    solid.facets.push_back({from + floor, to + floor, to});
    solid.facets.push_back({from + floor, to, from});
  };
  for (std::uint32_t i = 0; i + 1 < columns; ++i) wall(i, i + 1), wall(floor - 1 - i, floor - 2 - i);
  for (std::uint32_t k = 0; k + 1 < rows; ++k)
    wall((k + 1) * columns - 1, (k + 2) * columns - 1), wall((k + 1) * columns, k * columns);
  const SignedDistance plain(solid);
  ASSERT_TRUE(plain.has_volume());
  const RigidTransform pose = random_pose(random, 1);
  World world;
  world.add(robot::HeightField{heights, columns, rows, 0.5, pose});
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = Vec3{1, 0.75, 0} + random_point(random, 1.5);
    ASSERT_NEAR(world.nearest(pose(p)).distance, plain(p), 1e-9);
  }
}

TEST(Worlds, BordersOfTerrainLeadOutward) {
  World world;
  world.add(robot::HeightField{std::vector<double>(4), 2, 2});
  const std::array<std::pair<Vec3, Vec3>, 4> borders{{{{0, 0.5, -0.3}, {-1, 0, 0}},
                                                      {{1, 0.5, -0.3}, {1, 0, 0}},
                                                      {{0.5, 0, -0.3}, {0, -1, 0}},
                                                      {{0.5, 1, -0.3}, {0, 1, 0}}}};
  for (const auto& [on, outward] : borders) {
    for (const double out : {-1e-3, 0.0, 1e-200, 1e-3}) {
      const robot::NearestObstacle found = world.nearest(on + out * outward);
      EXPECT_NEAR(found.distance, out, 1e-15);
      EXPECT_EQ(found.direction, outward) << out;
    }
  }
}

}  // namespace
}  // namespace morula::test::configurations
