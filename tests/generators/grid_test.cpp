// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <generators/fit/lattice.hpp>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/query/signed_distance.hpp>
#include <set>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

TEST(Grid, divides_a_long_box_crosswise_whatever_its_orientation) {
  // 8 × 1 × 1: eight unit cubes in a row, and no looser than the eight spheres around them by more than a tenth: the
  // fit minimizes volume, and reaches the cubes themselves only as far as its grid sees.
  Mesh mesh = test::box_mesh({0, 0, 0}, {8, 1, 1}, 16);
  for (const double degrees : {0.0, 30.0}) {
    const auto [s, c] = sin_cos(degrees * 0.017453292519943295);
    Mesh turned = mesh;
    for (Vec3& p : turned.positions) p = {p.x * c - p.y * s, p.x * s + p.y * c, p.z};
    const CoveredTree model = build(turned, {.method = Method::grid, .depth = 1});
    ASSERT_EQ(model.tree.child_count[0], 8u);
    std::vector<Sphere> around_cubes;
    for (int i = 0; i < 8; ++i) {
      const Vec3 middle{i + 0.5, 0.5, 0.5};
      around_cubes.push_back(
          {{middle.x * c - middle.y * s, middle.x * s + middle.y * c, middle.z}, 0.5 * std::sqrt(3.0)});
    }
    EXPECT_LT(looseness(turned, level_set_spheres(model.tree, 1)).looseness.value(),
              1.1 * looseness(turned, around_cubes).looseness.value());
  }
}

TEST(Grid, spheres_of_a_ball_hardly_stick_out_of_it) {
  const Mesh mesh = test::icosphere(4);
  const SignedDistance shape(mesh);
  const CoveredTree model = build(mesh, {.method = Method::grid, .depth = 1});
  EXPECT_GE(model.tree.child_count[0], 6u);
  for (const Sphere& s : model.tree.spheres) EXPECT_LT(shape.protrusion_bound(s), 0.15);
}

TEST(Lattice, principal_axes_are_orthonormal_and_ordered_by_spread) {
  Random random(3);
  std::vector<Vec3> points;
  const Vec3 axis = normalized(Vec3{1, 2, 3});
  for (int i = 0; i < 500; ++i)
    points.push_back(axis * random.uniform(-5, 5) +
                     Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * 0.3);
  const Axes axes = principal_axes(points);
  EXPECT_GT(std::abs(dot(axes[0], axis)), 0.999);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(dot(axes[i], axes[j]), i == j ? 1 : 0, 1e-12);
  const Axes turned = turned_by_45_degrees(axes, 0);
  EXPECT_NEAR(dot(turned[1], axes[1]), std::sqrt(0.5), 1e-12);
  for (const Vec3& p : in_axes(axes, points)) EXPECT_LT(distance(p, in_axes(axes, {{out_of_axes(axes, p)}})[0]), 1e-12);
}

TEST(Lattice, occupied_cells_are_those_that_hold_points) {
  Random random(4);
  std::vector<Vec3> points;
  for (int i = 0; i < 200; ++i) points.push_back({random.uniform(), random.uniform(), random.uniform()});
  const Lattice lattice{{-0.1, -0.2, -0.3}, {0.3, 0.5, 0.7}};
  std::set<std::array<int, 3>> expected;
  for (const Vec3& p : points)
    expected.insert({static_cast<int>((p.x + 0.1) / 0.3), static_cast<int>((p.y + 0.2) / 0.5),
                     static_cast<int>((p.z + 0.3) / 0.7)});
  std::vector<Vec3> centers;
  const LatticePoints held(points);
  EXPECT_FALSE(held.occupied_cells(lattice, expected.size() - 1, centers));
  ASSERT_TRUE(held.occupied_cells(lattice, expected.size(), centers));
  EXPECT_EQ(centers.size(), expected.size());
}

// The other axes tell points apart; without extent, and so without an edge, an axis has one cell.
TEST(Lattice, axes_without_extent_have_one_cell) {
  const std::vector<Vec3> points{{0.25, 1, 2}, {0.75, 1, 2}, {0.8, 1, 2}};
  std::vector<Vec3> centers;
  for (const double none : {0.0, 1e-310}) {
    ASSERT_TRUE(LatticePoints(points).occupied_cells({{0, 1, 2}, {0.5, none, none}}, 100, centers));
    EXPECT_EQ(centers.size(), 2u) << none;
    const LatticePoints one(std::span<const Vec3>(points).first(1));
    ASSERT_TRUE(one.occupied_cells({points[0], {none, none, none}}, 100, centers));
    EXPECT_EQ(centers.size(), 1u) << none;
  }
}

TEST(Lattice, greedy_cover_contains_every_point_and_needs_no_more_than_all_cells) {
  Random random(5);
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) points.push_back({random.uniform(), random.uniform(), random.uniform()});
  const Lattice lattice{{0, 0, 0}, {0.34, 0.34, 0.34}};
  std::vector<Vec3> centers;
  const LatticePoints held(points);
  ASSERT_TRUE(held.occupied_cells(lattice, 100, centers));
  const auto chosen = held.greedy_cover(centers, lattice.cell_radius(), centers.size());
  EXPECT_LT(chosen.size(), centers.size());
  for (const Vec3& p : points) {
    bool inside = false;
    for (const std::uint32_t c : chosen)
      inside = inside || distance(p, centers[c]) <= lattice.cell_radius() * (1 + 1e-9);
    EXPECT_TRUE(inside);
  }
  // Where fewer are wanted, as many of the same as tell that they do not do.
  const auto begin = held.greedy_cover(centers, lattice.cell_radius(), chosen.size() - 2);
  ASSERT_EQ(begin.size(), chosen.size() - 1);
  EXPECT_TRUE(std::equal(begin.begin(), begin.end(), chosen.begin()));
}

}  // namespace
}  // namespace morula
