// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <set>
#include <support/numbers.hpp>

#include "stale_pose.hpp"

namespace morula {
namespace {

TEST(RigidTransform, undoes_and_composes) {
  const RigidTransform a = RigidTransform::from_axis({1, 2, -3}, 0.7, {4, 5, 6});
  const RigidTransform b = RigidTransform::from_quaternion(0.2, -3, 1, 0.5, {-1, 0, 2});
  EXPECT_LE(deviation_from_rigid(a), 1e-15);
  EXPECT_LE(deviation_from_rigid(b), 1e-15);
  const Vec3 p{0.3, -0.8, 1.9};
  EXPECT_LE(distance(inverse(a)(a(p)), p), 1e-14);
  EXPECT_LE(distance(relative_to(a, b)(p), inverse(a)(b(p))), 1e-14);
  EXPECT_EQ(RigidTransform{}(p), p) << "the identity keeps bits";
}

TEST(RigidTransform, turns_right_handed_about_its_axis) {
  const Vec3 turned = RigidTransform::from_axis({0, 0, 5}, std::numbers::pi / 2)({1, 0, 7});
  EXPECT_LE(distance(turned, Vec3{0, 1, 7}), 1e-15);
}

TEST(RigidTransform, tells_what_is_not_rigid) {
  using test::infinity;
  RigidTransform t;
  t.rows[1].y = -1;
  EXPECT_EQ(deviation_from_rigid(t), infinity) << "a reflection";
  t = {};
  t.translation.z = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(deviation_from_rigid(t), infinity);
  t = {};
  t.rows[0].x = 1.5;
  EXPECT_DOUBLE_EQ(deviation_from_rigid(t), 1.25) << "a stretch";
}

struct Limb : ::testing::Test {
  Mesh mesh = sample_body("limb");
  CoveredTree built = build(mesh, {.method = Method::octree, .depth = 3});
  Body body{mesh, built};
};

TEST_F(Limb, collider_lists_the_facets_of_each_region) {
  const Collider collider(mesh, body);
  for (std::uint32_t node = 0; node < built.tree.node_count(); ++node) {
    std::set<std::uint32_t> owned;
    for (std::uint32_t p = built.cover.region_begin[node]; p < built.cover.region_end[node]; ++p)
      owned.insert(built.cover.patch_facet[p]);
    const auto listed = collider.facets(node);
    EXPECT_EQ(std::set<std::uint32_t>(listed.begin(), listed.end()), owned);
    if (built.tree.is_leaf(node)) {
      EXPECT_EQ(listed.size(), owned.size());
    }
  }
}

TEST_F(Limb, collider_knows_whether_its_positions_are_current) {
  Collider collider(mesh, body);
  EXPECT_TRUE(collider.has_current_positions()) << "at rest the mesh's own serve";
  EXPECT_EQ(collider.triangle(7), mesh.corners(7));

  std::vector<Vec3> moved = mesh.positions;
  for (Vec3& p : moved) p.x *= 1.5;
  ASSERT_TRUE(body.update(moved));
  EXPECT_TRUE(collider.has_current_positions()) << "the body was given them";
  EXPECT_EQ(collider.vertex(11), moved[11]);
  test::StalePose late(mesh, built.cover, body.pose());
  EXPECT_FALSE(late.collider.has_current_positions());
  late.collider.set_positions(moved);
  EXPECT_TRUE(late.collider.has_current_positions());
  EXPECT_EQ(late.collider.vertex(11), moved[11]);
  late.next_frame();
  EXPECT_FALSE(late.collider.has_current_positions());
  const RigidTransform placement = RigidTransform::from_axis({1, 1, 0}, 1.0, {0, 0, 3});
  collider.place(placement);
  EXPECT_EQ(collider.vertex(11), placement(moved[11]));
}

TEST_F(Limb, collider_refuses_what_does_not_fit_and_changes_nothing) {
  Collider collider(mesh, body);
  RigidTransform bent;
  bent.rows[0].y = 0.1;
  EXPECT_THROW(collider.place(bent), std::invalid_argument);
  EXPECT_EQ(collider.placement(), RigidTransform{});
  const std::vector<Vec3> few(3);
  EXPECT_THROW(collider.set_positions(few), std::invalid_argument);
  EXPECT_TRUE(collider.has_current_positions());
  EXPECT_THROW(Collider(sample_body("torus"), body), std::invalid_argument);
}

TEST_F(Limb, body_counts_good_updates_and_knows_when_it_lags) {
  const Body twin(mesh, built);
  const Body other(mesh, build(mesh, {.method = Method::grid, .depth = 3}));
  EXPECT_EQ(body.ownership(), twin.ownership());
  EXPECT_NE(body.ownership(), other.ownership());

  EXPECT_EQ(body.frame(), 0u);
  ASSERT_TRUE(body.update(mesh.positions));
  EXPECT_EQ(body.frame(), 1u);
  std::vector<Vec3> bad = mesh.positions;
  bad[mesh.facets[0][0]].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(body.update(bad));
  EXPECT_EQ(body.frame(), 1u);
  EXPECT_FALSE(body.is_current());
  ASSERT_TRUE(body.update(mesh.positions));
  EXPECT_TRUE(body.is_current());
  EXPECT_EQ(body.frame(), 2u);
}

}  // namespace
}  // namespace morula
