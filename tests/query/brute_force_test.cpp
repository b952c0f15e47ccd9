// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The oracles themselves, where the answer is known by hand.
#include <gtest/gtest.h>

#include <scenes/brute_force.hpp>
#include <support/meshes.hpp>

namespace morula {
namespace {

using test::box_mesh;
using test::inverted;
using test::joined;

TEST(BruteForce, closest_point_of_a_cube) {
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1});
  const ClosestFacetPoint found = brute_force::closest_point(cube, {0.25, 0.5, 1.75});
  EXPECT_EQ(found.point, Vec3(0.25, 0.5, 1));
  EXPECT_EQ(found.squared_distance, 0.5625);
  EXPECT_EQ(at_barycentric(cube.corners(found.facet), found.barycentric), found.point);
  const ClosestFacetPoint corner = brute_force::closest_point(cube, {2, 2, 2});
  EXPECT_EQ(corner.point, Vec3(1, 1, 1));
  for (std::uint32_t f = 0; f < corner.facet; ++f)
    for (const Vec3& p : cube.corners(f)) EXPECT_NE(p, Vec3(1, 1, 1));
}

TEST(BruteForce, facets_touching_counts_a_touch) {
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(brute_force::facets_touching(cube, {{0.25, 0.5, 1.5}, 0.5}).size(), 1u);
  EXPECT_EQ(brute_force::facets_touching(cube, {{0.25, 0.5, 1.5}, 0.499}).size(), 0u);
  EXPECT_EQ(brute_force::facets_touching(cube, {{0.5, 0.5, 0.5}, 0.5}).size(), 12u);
  EXPECT_EQ(brute_force::facets_touching(cube, {{0, 0, 0}, -1}).size(), 0u);
}

TEST(BruteForce, winding_number_counts_and_clamps_nothing) {
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1}, 2);
  const Vec3 in{0.3, 0.4, 0.6}, out{0.3, 0.4, 1.6};
  EXPECT_NEAR(brute_force::winding_number(cube, in), 1, 1e-14);
  EXPECT_NEAR(brute_force::winding_number(cube, out), 0, 1e-14);
  EXPECT_NEAR(brute_force::winding_number(inverted(cube), in), -1, 1e-14);
  EXPECT_NEAR(brute_force::winding_number(joined(cube, cube), in), 2, 1e-14);
  // Half a cube's side seen from its middle, from either side of it: a quarter of a sixth of all directions.
  const Mesh facet{{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}}, {{0, 5, 6}}};
  EXPECT_NEAR(brute_force::winding_number(facet, {0, 0, 0}), 1.0 / 24, 1e-15);
  EXPECT_NEAR(brute_force::winding_number(facet, {0, 0, 2}), -1.0 / 24, 1e-15);
}

TEST(BruteForce, inside_volume_of_a_ball_half_in_a_cube) {
  const Mesh cube = box_mesh({0, 0, 0}, {1, 1, 1});
  const Sphere ball{{0.5, 0.5, 1}, 0.25};
  EXPECT_NEAR(brute_force::inside_volume(cube, ball, 8000) / volume(ball), 0.5, 0.005);
  EXPECT_EQ(brute_force::inside_volume(cube, ball, 100, 3), brute_force::inside_volume(cube, ball, 100, 3));
  EXPECT_NE(brute_force::inside_volume(cube, ball, 100, 3), brute_force::inside_volume(cube, ball, 100, 5));
  EXPECT_EQ(brute_force::inside_volume(cube, {{0.5, 0.5, 0.5}, 0.1}, 1), volume(Sphere{{}, 0.1}));
}

}  // namespace
}  // namespace morula
