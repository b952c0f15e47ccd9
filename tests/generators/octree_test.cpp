// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/generators/build.hpp>
#include <support/meshes.hpp>

namespace morula {
namespace {

TEST(Octree, divides_a_cube_into_its_octants) {
  // An octant of the unit cube's surface is three squares of side ½ that meet in a corner. That corner and the squares'
  // far corners form a regular tetrahedron of edge √½, and the smallest sphere is around it.
  const Mesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1}, 4);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 1});
  ASSERT_EQ(model.tree.child_count[0], 8u);
  EXPECT_EQ(model.cover.cut_points.size(), 0u);  // the cell walls run along edges of this mesh
  for (std::uint32_t i = 1; i <= 8; ++i) {
    const Sphere& s = model.tree.spheres[i];
    EXPECT_NEAR(s.radius, std::sqrt(3.0) / 4, 1e-12);
    for (int axis = 0; axis < 3; ++axis) {
      const double c = s.center[axis];
      EXPECT_NEAR(std::min(c, 1 - c), 0.25, 1e-9);
    }
  }
}

TEST(Octree, skips_cells_with_a_single_occupied_octant) {
  // Two small cubes far apart: after the first division each cell holds one cube, small in its cell. Its children must
  // be octants of the cube, not of the cell.
  const Mesh mesh =
      test::joined(test::box_mesh({0, 0, 0}, {0.01, 0.01, 0.01}, 2), test::box_mesh({0.99, 0.99, 0.99}, {1, 1, 1}, 2));
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  EXPECT_EQ(model.tree.child_count[0], 2u);
  EXPECT_GE(model.tree.child_count[1], 4u);
  EXPECT_GE(model.tree.child_count[2], 4u);
}

// A tetrahedron with two corners in one place and a facet that is a segment: it stays whole, sticks out of its cell,
// and all other pieces, which touch their cells' spheres, used to follow it. Sixty halvings then cut them to dust for
// nothing.
TEST(Octree, a_facet_that_stays_whole_does_not_draw_the_others_into_its_cell) {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.facets = {{0, 2, 0}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const int branching : {4, 8}) {
    const CoveredTree model = build(mesh, {.method = Method::octree, .branching = branching, .depth = 2});
    EXPECT_GE(model.tree.child_count[0], 3u);
    EXPECT_EQ(model.tree.level_count(), 3u);
    EXPECT_TRUE(validate(mesh, model).empty());
  }
}

TEST(Octree, joins_octants_when_fewer_children_are_asked_for_and_divides_further_when_more) {
  const Mesh mesh = test::icosphere(4);
  for (const int branching : {2, 3, 5, 12, 40}) {
    const CoveredTree model = build(mesh, {.method = Method::octree, .branching = branching, .depth = 1});
    EXPECT_LE(model.tree.child_count[0], static_cast<std::uint32_t>(branching));
    EXPECT_GE(2 * model.tree.child_count[0], static_cast<std::uint32_t>(branching)) << branching;
  }
}

}  // namespace
}  // namespace morula
