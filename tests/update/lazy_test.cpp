// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lazy updates: the spheres of full ones, but only those that somebody asks for.
#include <gtest/gtest.h>

#include <limits>
#include <morula/update/body.hpp>

#include "bodies.hpp"

namespace morula {
namespace {

using test::Specimen;
using test::specimens;

// Calls visit(node) for all that reach() makes readable, parents first.
template <class Visit>
void reach_all(Body& body, const Visit& visit) {
  const SphereTree& tree = body.rest_tree();
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    ASSERT_TRUE(body.is_fresh(node)) << node;
    visit(node);
    body.refresh_children(node);
  }
}

TEST(LazyUpdate, gives_the_spheres_of_a_full_one_when_all_are_reached) {
  Workers three(3);
  for (const Specimen& b : specimens()) {
    Body full(b.mesh, b.model), lazy(b.mesh, b.model);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const std::vector<Vec3> positions = test::noisy(b.mesh.positions, 0.1, seed);
      ASSERT_TRUE(full.update(positions));
      for (std::size_t level = 0; level <= b.model.tree.level_count(); ++level) {
        const UpdateStatus status = lazy.update_lazily(positions, level, three);
        ASSERT_TRUE(status);
        const std::size_t deepest = std::min(level, b.model.tree.level_count() - 1);
        EXPECT_EQ(status.nodes_updated, b.model.tree.level_begin[deepest + 1]);
        reach_all(lazy, [&](std::uint32_t node) {
          ASSERT_EQ(lazy.sphere(node), full.sphere(node)) << b.name << ", node " << node;
        });
        EXPECT_TRUE(lazy.is_complete());
        EXPECT_EQ(lazy.hash(), full.hash()) << b.name;
      }
    }
  }
}

TEST(LazyUpdate, brings_each_child_once_and_no_other_node) {
  const Specimen b = specimens().front();
  const SphereTree& tree = b.model.tree;
  Body body(b.mesh, b.model);
  ASSERT_TRUE(body.update_lazily(test::noisy(b.mesh.positions, 0.1, 1), 0));
  std::size_t reached = 0;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) reached += body.is_fresh(node);
  EXPECT_EQ(reached, 1u);
  EXPECT_FALSE(body.is_complete());
  EXPECT_EQ(body.refresh_children(0), tree.child_count[0]);
  EXPECT_EQ(body.refresh_children(0), 0u);
  for (std::uint32_t node = 1; node < tree.node_count(); ++node)
    EXPECT_EQ(body.is_fresh(node), tree.parent[node] == 0) << node;
}

TEST(LazyUpdate, is_followed_by_any_other_update) {
  const Specimen b = specimens().front();
  Body lazy(b.mesh, b.model), full(b.mesh, b.model);
  std::vector<Vec3> positions = test::noisy(b.mesh.positions, 0.1, 1);
  ASSERT_TRUE(lazy.update_lazily(positions, 1));
  positions[b.mesh.facets[0][0]].x += 0.01;
  const VertexRange range{b.mesh.facets[0][0], b.mesh.facets[0][0] + 1};
  ASSERT_TRUE(lazy.update(positions, std::span(&range, 1)));
  ASSERT_TRUE(full.update(positions));
  EXPECT_EQ(lazy.hash(), full.hash()) << "what a partial update needs of the frame before is not there";
  for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) EXPECT_TRUE(lazy.is_fresh(node));
}

TEST(LazyUpdate, keeps_what_was_reached_when_the_next_is_refused) {
  const Specimen b = specimens().front();
  Body body(b.mesh, b.model);
  ASSERT_TRUE(body.update_lazily(test::noisy(b.mesh.positions, 0.1, 1), 0));
  body.refresh_children(0);
  const std::uint64_t before = body.hash();
  std::vector<Vec3> bad = b.mesh.positions;
  bad[b.mesh.facets[0][0]].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(body.update_lazily(bad, 0));
  EXPECT_FALSE(body.update_lazily(std::vector<Vec3>(2), 0));
  EXPECT_EQ(body.refresh_children(1), 0u) << "the points of the good frame are gone";
  EXPECT_EQ(body.hash(), before);
  EXPECT_TRUE(body.is_fresh(1));
  EXPECT_FALSE(body.is_current());
}

TEST(LazyUpdate, is_a_full_one_where_rules_need_their_children) {
  const Specimen b = specimens().front();
  const std::vector<Vec3> positions = test::noisy(b.mesh.positions, 0.1, 1);
  for (const Rule rule : {Rule::approach2, Rule::wrapped}) {
    Body lazy(b.mesh, b.model, {.rules = {rule}}), full(b.mesh, b.model, {.rules = {rule}});
    ASSERT_TRUE(lazy.update_lazily(positions, 0));
    ASSERT_TRUE(full.update(positions));
    EXPECT_EQ(lazy.hash(), full.hash());
    EXPECT_EQ(lazy.refresh_children(0), 0u);
  }
}

TEST(LazyUpdate, by_modes_gives_the_spheres_of_a_full_one) {
  for (const Specimen& b : specimens()) {
    const Modes modes = test::smooth_modes(b.mesh, 4);
    Body full(b.mesh, b.model, {.rules = {Rule::modal}, .modes = modes});
    Body lazy = full;
    std::vector<double> q{0.3, -0.2, 0.0, 0.1};
    ASSERT_TRUE(full.update_modal(q));
    ASSERT_TRUE(lazy.update_modal_lazily(q, 0));
    q.assign(4, 7.0);  // not borrowed
    reach_all(lazy, [&](std::uint32_t node) { ASSERT_EQ(lazy.sphere(node), full.sphere(node)) << b.name; });
    EXPECT_EQ(lazy.hash(), full.hash()) << b.name;
    EXPECT_FALSE(lazy.update_modal_lazily(std::span(q).first(2), 0));
  }
}

}  // namespace
}  // namespace morula
