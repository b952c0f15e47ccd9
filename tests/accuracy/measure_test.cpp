// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/accuracy/measure.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <stdexcept>
#include <support/meshes.hpp>

namespace morula {
namespace {

using test::box_mesh;

Sphere around(const Vec3& lower, const Vec3& upper) {
  return {(lower + upper) * 0.5, 0.5 * distance(lower, upper) * (1 + 1e-12)};
}

// A bar of 4 × 1 × 1: one sphere; two halves; the left one ends there, the right one has two quarters.
SphereTree bar_tree() {
  SphereTree tree;
  const std::vector<Sphere> root{around({0, 0, 0}, {4, 1, 1})};
  const std::vector<Sphere> halves{around({0, 0, 0}, {2, 1, 1}), around({2, 0, 0}, {4, 1, 1})};
  const std::vector<Sphere> quarters{around({2, 0, 0}, {3, 1, 1}), around({3, 0, 0}, {4, 1, 1})};
  tree.append_level({}, root);
  tree.append_level(std::vector<std::uint32_t>{2}, halves);
  tree.append_level(std::vector<std::uint32_t>{0, 2}, quarters);
  return tree;
}

TEST(Measure, takes_leaves_that_ended_early_into_deeper_levels) {
  const Mesh bar = box_mesh({0, 0, 0}, {4, 1, 1}, 3);
  const auto levels = measure(bar, bar_tree());
  ASSERT_EQ(levels.size(), 3u);
  const std::size_t expected[] = {1, 2, 3};
  for (std::size_t level = 0; level < 3; ++level) {
    const LevelMeasure& m = levels[level];
    EXPECT_EQ(m.level, level);
    EXPECT_EQ(m.spheres, expected[level]);
    EXPECT_TRUE(m.coverage.covered) << "level " << level << ": gap " << m.coverage.uncovered_distance;
    EXPECT_EQ(m.looseness.missed_volume, 0.0);
    ASSERT_TRUE(m.protrusion);
    EXPECT_NEAR(m.looseness.object_volume, 4, 1e-12);
    if (level == 0) continue;
    EXPECT_LT(*m.looseness.looseness, *levels[level - 1].looseness.looseness);
    EXPECT_LE(m.protrusion->mean, levels[level - 1].protrusion->mean);
  }
  // A ball around a box sticks out most above the nearest side.
  EXPECT_NEAR(levels[0].protrusion->worst, std::sqrt(18.0) / 2 - 0.5, 0.03);
  EXPECT_NEAR(levels[2].protrusion->worst, std::sqrt(6.0) / 2 - 0.5, 0.02);
  EXPECT_NEAR(levels[2].protrusion->mean, (std::sqrt(6.0) / 2 + std::sqrt(3.0)) / 3 - 0.5, 0.02);
}

TEST(Measure, equals_the_single_measures) {
  const Mesh bar = box_mesh({0, 0, 0}, {4, 1, 1}, 3);
  SphereTree tree = bar_tree();
  for (Sphere& s : tree.spheres) s.radius *= 0.95;
  const VoxelGrid grid{.kind = VoxelGrid::Kind::fixed, .voxel_edge = 0.05};
  Workers three(3);
  const auto levels = measure(bar, tree, {.grid = grid, .protrusion_tolerance = 0.05}, three);
  const SignedDistance object(bar);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const auto spheres = level_set_spheres(tree, level);
    const Looseness l = looseness(bar, spheres, grid);
    EXPECT_EQ(levels[level].looseness.looseness, l.looseness);
    EXPECT_EQ(levels[level].looseness.missed_volume, l.missed_volume);
    EXPECT_GT(*l.missed_volume, 0);
    const Coverage c = coverage(bar, spheres);
    EXPECT_FALSE(c.covered);
    EXPECT_EQ(levels[level].coverage.uncovered_distance, c.uncovered_distance);
    EXPECT_EQ(levels[level].coverage.uncovered_area, c.uncovered_area);
    const Protrusion p = protrusion(object, spheres, 0.05);
    EXPECT_EQ(levels[level].protrusion->worst, p.worst);
    EXPECT_EQ(levels[level].protrusion->mean, p.mean);
  }
}

TEST(Measure, takes_no_protrusion_where_there_is_no_inside) {
  SphereTree tree;
  tree.append_level({}, std::vector<Sphere>{{{0.5, 0.5, 0}, 0.75}});
  Mesh unoriented = box_mesh({0, 0, -0.1}, {1, 1, 0.1});
  std::swap(unoriented.facets[0][0], unoriented.facets[0][1]);
  for (const Mesh& mesh : {test::grid_plate(4), unoriented}) {
    const auto levels = measure(mesh, tree);
    ASSERT_EQ(levels.size(), 1u);
    EXPECT_FALSE(levels[0].protrusion);
    EXPECT_TRUE(levels[0].coverage.covered);
  }
  EXPECT_FALSE(measure(test::grid_plate(4), tree)[0].looseness.looseness);
  EXPECT_TRUE(measure(unoriented, tree)[0].looseness.looseness);
  EXPECT_FALSE(measure(box_mesh({0, 0, -0.1}, {1, 1, 0.1}), tree, {.with_protrusion = false})[0].protrusion);
}

TEST(Measure, refuses_broken_trees_and_meshes) {
  const Mesh bar = box_mesh({0, 0, 0}, {4, 1, 1});
  SphereTree tree = bar_tree();
  tree.parent[3] = 0;
  EXPECT_THROW(measure(bar, tree), std::invalid_argument);
  tree = bar_tree();
  tree.spheres[1].radius = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(measure(bar, tree), std::invalid_argument);
  EXPECT_THROW(measure(Mesh{}, bar_tree()), std::invalid_argument);
}

}  // namespace
}  // namespace morula
