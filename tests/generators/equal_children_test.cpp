// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A child as large as its parent is no child: such a node is a leaf.
#include <gtest/gtest.h>

#include <algorithm>
#include <generators/driver/equal_children.hpp>
#include <morula/accuracy/looseness.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/body.hpp>
#include <morula/update/rebuilt_body.hpp>
#include <support/meshes.hpp>
#include <support/methods.hpp>

namespace morula {
namespace {

// The ball and bodies that are not far from one.
struct Named {
  const char* name;
  Mesh mesh;
};
Mesh stretched(Mesh mesh, const Vec3& by) {
  for (Vec3& p : mesh.positions) p = {p.x * by.x, p.y * by.y, p.z * by.z};
  return mesh;
}
std::vector<Named> round_and_flat_bodies() {
  const Mesh ball = test::icosphere(2);
  return {{"ball", test::scaled(ball, 3)},
          {"coarse ball", test::icosphere(1)},
          {"half in size, moved", test::translated(test::scaled(ball, 0.5), {10, -20, 5})},
          {"ellipsoid", stretched(ball, {1, 1, 1.02})},
          {"long ellipsoid", stretched(ball, {1, 1, 3})},
          {"disc", stretched(ball, {1, 1, 0.02})},
          {"box", test::box_mesh({0, 0, 0}, {1, 1, 1}, 5)},
          {"two balls", test::joined(ball, test::translated(ball, {4, 0, 0}))},
          {"ball in a ball", test::joined(ball, test::inverted(test::scaled(ball, 0.9)))}};
}

// Nodes with a leaf of their own size among their children.
std::vector<std::uint32_t> useless_divisions(const SphereTree& tree) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t node = 1; node < tree.node_count(); ++node)
    if (const Sphere& parent = tree.spheres[tree.parent[node]];
        tree.child_count[node] == 0 && tree.spheres[node].radius >= 0.999 * parent.radius &&
        distance(tree.spheres[node].center, parent.center) <= 0.001 * parent.radius)
      found.push_back(tree.parent[node]);
  return found;
}

BuildOptions options_of(Method method) {
  return {.method = method, .quality = method == Method::optimized ? Quality::fast : Quality::standard};
}

class EqualChildrenBy : public test::ByMethod {};

TEST_P(EqualChildrenBy, are_in_no_tree_of_automatic_depth) {
  for (const Named& body : round_and_flat_bodies()) {
    const CoveredTree model = build(body.mesh, options_of(GetParam()));
    EXPECT_TRUE(useless_divisions(model.tree).empty()) << body.name;
    const auto faults = validate(body.mesh, model);
    EXPECT_TRUE(faults.empty()) << body.name << ": " << faults.front();
    std::size_t early = 0;
    for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
      early += model.tree.is_leaf(node) && model.tree.level_of(node) + 1 < model.tree.level_count();
    EXPECT_EQ(model.report.early_leaves, early) << body.name;
    EXPECT_LE(model.report.level_seconds.size(), model.tree.level_count()) << body.name;
  }
}

TEST_P(EqualChildrenBy, leave_a_ball_one_sphere_unless_a_depth_is_given) {
  const Mesh ball = test::icosphere(2);
  BuildOptions options = options_of(GetParam());
  const CoveredTree one = build(ball, options);
  EXPECT_EQ(one.tree.node_count(), 1u);
  EXPECT_EQ(one.report.depth, 2u);
  ASSERT_FALSE(one.report.notes.empty());
  EXPECT_EQ(one.cover.patch_count(), ball.facet_count()) << "no facet needs to be cut for one sphere";
  options.depth = 2;
  const CoveredTree parts = build(ball, options);
  // Spawn proposes one sphere for a ball, and that alone is no level.
  EXPECT_GT(parts.tree.leaf_count(), GetParam() == Method::spawn ? 0u : 1u);
  for (const std::uint32_t node : useless_divisions(parts.tree)) EXPECT_EQ(node, 0u);
}

INSTANTIATE_TEST_SUITE_P(Quick, EqualChildrenBy, testing::ValuesIn(test::quick_methods), test::method_name);
INSTANTIATE_TEST_SUITE_P(Long, EqualChildrenBy, testing::ValuesIn(test::slow_methods), test::method_name);

TEST(EqualChildren, are_in_no_default_tree_of_a_ball) {
  const CoveredTree model = build(test::icosphere(2));
  EXPECT_EQ(model.tree.node_count(), 1u);
}

// An exchange may give a leaf so much that it is as large as its parent, but not the same sphere.
TEST(EqualChildren, elsewhere_are_children) {
  CoveredTree model;
  model.tree.branching = 2;
  model.tree.append_level({}, std::vector<Sphere>{{{0, 0, 0}, 1}});
  model.tree.append_level(std::vector<std::uint32_t>{2}, std::vector<Sphere>{{{0.1, 0, 0}, 1}, {{0, 0, 0}, 0.5}});
  model.cover.region_begin = {0, 0, 1};
  model.cover.region_end = {2, 1, 2};
  CoveredTree same = model;
  EXPECT_EQ(detail::remove_equal_children(model, true), 0u);
  EXPECT_EQ(model.tree.node_count(), 3u);
  same.tree.spheres[1].center = {0.0005, 0, 0};
  EXPECT_EQ(detail::remove_equal_children(same, false), 0u);
  EXPECT_EQ(detail::remove_equal_children(same, true), 1u);
  EXPECT_EQ(same.tree.node_count(), 1u);
  EXPECT_EQ(same.cover.region_end, std::vector<std::uint32_t>{2});
}

// A ball that is one sphere at rest has parts as soon as it is stretched.
TEST(EqualChildren, come_with_the_pose_in_a_rebuilt_body) {
  const Mesh ball = test::icosphere(2);
  RebuiltBody body(ball, build(ball, {.method = Method::octree}),
                   {.method = Method::octree,
                    .check_every = 1,
                    .rebuild_every = 1,
                    .min_improvement = -1e9,
                    .thread = RebuildThread::caller});
  ASSERT_EQ(body.body().rest_tree().node_count(), 1u);
  const Mesh long_ball = stretched(ball, {4, 1, 1});
  for (int frame = 0; frame < 4; ++frame) ASSERT_TRUE(body.update(long_ball.positions));
  EXPECT_GT(body.body().rest_tree().node_count(), 4u);
}

}  // namespace
}  // namespace morula
