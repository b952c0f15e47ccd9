// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>
#include <numeric>

namespace morula {
namespace {

class Renumbering : public testing::Test {
 protected:
  Mesh mesh = sample_body("limb", 16);
  CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
};

TEST_F(Renumbering, names_every_vertex_once_and_keeps_every_promise_of_the_tree) {
  const std::vector<std::uint32_t> order = leaf_order(model);
  std::vector<std::uint32_t> sorted = order, all(mesh.vertex_count());
  std::iota(all.begin(), all.end(), 0u);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_EQ(sorted, all);
  EXPECT_NE(order, all);

  const Mesh moved = renumbered(mesh, order);
  const CoveredTree moved_built = renumbered(model, moved, order);
  EXPECT_TRUE(validate(moved, moved_built).empty());
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) EXPECT_EQ(moved.corners(f), mesh.corners(f));
  for (std::uint32_t c = 0; c < model.cover.corners.size(); ++c)
    EXPECT_EQ(corner_position(moved_built.cover, moved_built.cover.corners[c], moved.positions),
              corner_position(model.cover, model.cover.corners[c], mesh.positions));
  EXPECT_EQ(tree_hash(moved_built.tree), tree_hash(model.tree));
}

TEST_F(Renumbering, is_settled_after_one_time) {
  const std::vector<std::uint32_t> order = leaf_order(model);
  const Mesh moved = renumbered(mesh, order);
  const std::vector<std::uint32_t> again = leaf_order(renumbered(model, moved, order));
  EXPECT_TRUE(std::is_sorted(again.begin(), again.end()));
}

TEST_F(Renumbering, changes_no_radius_of_a_body_by_more_than_rounding) {
  const std::vector<std::uint32_t> order = leaf_order(model);
  const Mesh moved = renumbered(mesh, order);
  Body before(mesh, model), after(moved, renumbered(model, moved, order));
  std::vector<Vec3> stretched, stretched_moved;
  for (const Vec3& p : mesh.positions) stretched.push_back({1.5 * p.x, p.y, p.z});
  for (const Vec3& p : moved.positions) stretched_moved.push_back({1.5 * p.x, p.y, p.z});
  ASSERT_TRUE(before.update(stretched));
  ASSERT_TRUE(after.update(stretched_moved));
  for (std::uint32_t i = 0; i < model.tree.node_count(); ++i)
    EXPECT_NEAR(after.sphere(i).radius, before.sphere(i).radius, 0.02 * before.sphere(i).radius) << "node " << i;
}

TEST_F(Renumbering, refuses_what_is_no_order) {
  std::vector<std::uint32_t> order = leaf_order(model);
  order[3] = order[4];
  EXPECT_THROW(renumbered(mesh, order), std::invalid_argument);
  EXPECT_THROW(renumbered(model, mesh, order), std::invalid_argument);
  order[3] = 1u << 30;
  EXPECT_THROW(renumbered(mesh, order), std::invalid_argument);
  order.pop_back();
  EXPECT_THROW(renumbered(mesh, order), std::invalid_argument);
}

}  // namespace
}  // namespace morula
