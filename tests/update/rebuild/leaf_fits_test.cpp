// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Leaves whose centers are fitted in every frame: every level covers, spheres depend on positions alone, and rest is
// rest.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/rebuilt_body.hpp>

#include "covered_frames.hpp"
#include "limb.hpp"

namespace morula {
namespace {

using namespace test;

RebuildOptions fitting() {
  return {.effort = RebuildEffort::high, .thread = RebuildThread::none};
}

const Mesh& fine_limb() {
  static const Mesh mesh = sample_body("limb", 64);
  return mesh;
}
const CoveredTree& fine_limb_tree() {
  static const CoveredTree model = build(fine_limb(), {.depth = 3, .quality = Quality::draft});
  return model;
}

TEST(LeafFits, cover_in_every_frame_of_any_motion_on_every_specimen) {
  for (const Specimen& b : test::specimens()) {
    RebuiltBody body(b.mesh, b.model, fitting());
    test::move_a_specimen(b, body);
  }
}

TEST(LeafFits, cover_aligned_and_coarse_bodies_far_from_the_origin) {
  test::move_coarse_bodies(fitting());
}

// Leaves that fit closely. Those of a coarse tree, which do not, are about as tight as without.
TEST(LeafFits, are_tighter) {
  const Mesh& mesh = fine_limb();
  for (const Deformation& motion : std::vector<Deformation>{Stretch{2}, Twist{180}, Bend{90}, Noise{}}) {
    RebuiltBody fitted(mesh, fine_limb_tree(), fitting());
    RebuiltBody plain(mesh, fine_limb_tree(), {.thread = RebuildThread::none});
    double product = 1;
    for (int frame = 1; frame <= 12; ++frame) {
      const std::vector<Vec3> positions = deform(mesh, {motion}, frame / 24.0);
      ASSERT_TRUE(fitted.update(positions));
      ASSERT_TRUE(plain.update(positions));
      if (frame < 4) continue;
      const double ratio = estimate_looseness(mesh, fitted.body(), positions).back() /
                           estimate_looseness(mesh, plain.body(), positions).back();
      EXPECT_LT(ratio, 0.95) << describe(motion) << ", frame " << frame;
      product *= ratio;
    }
    EXPECT_LT(std::pow(product, 1.0 / 9), 0.9) << describe(motion);
  }
}

// Of a sheet, of a body that is one leaf, and of points that fall together. A core does not stand for what moves at
// random.
TEST(LeafFits, let_no_leaf_grow_by_more_than_a_little) {
  for (const Specimen& b : test::specimens()) {
    RebuiltBody fitted(b.mesh, b.model, fitting());
    Body plain(b.mesh, b.model);
    for (const test::Motion& motion : test::motions()) {
      if (std::string(motion.name) == "noise") continue;
      const std::vector<Vec3> positions = motion.apply(b.mesh.positions);
      ASSERT_TRUE(fitted.update(positions));
      ASSERT_TRUE(plain.update(positions));
      for (std::uint32_t node = 0; node < b.model.tree.node_count(); ++node) {
        const Spheref &now = fitted.body().spheres()[node], &without = plain.spheres()[node];
        if (!b.model.tree.is_leaf(node)) {
          EXPECT_EQ(now.center, without.center);
        }
        EXPECT_LE(now.radius, 1.1f * without.radius) << b.name << ", " << motion.name << ", node " << node;
      }
    }
  }
}

TEST(LeafFits, depend_on_positions_alone_whatever_came_before) {
  RebuiltBody body(limb(), limb_tree(), fitting()), jumping(limb(), limb_tree(), fitting());
  for (int frame = 1; frame <= 8; ++frame) ASSERT_TRUE(body.update(stretched_limb(frame / 8.0)));
  ASSERT_TRUE(jumping.update(stretched_limb(1)));
  EXPECT_EQ(body.body().hash(), jumping.body().hash());
}

TEST(LeafFits, have_the_same_bits_for_any_number_of_workers) {
  std::vector<std::uint64_t> hashes[3];
  for (const unsigned count : {1u, 2u, 3u}) {
    Workers workers(count);
    RebuiltBody body(fine_limb(), fine_limb_tree(), fitting(), workers);
    for (int frame = 1; frame <= 12; ++frame) {
      ASSERT_TRUE(body.update(deform(fine_limb(), {Twist{180}}, frame / 12.0), workers));
      hashes[count - 1].push_back(body.body().hash());
    }
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(LeafFits, return_to_rest_bit_for_bit_and_go_on_from_there_as_before) {
  RebuiltBody body(limb(), limb_tree(), fitting());
  const Body plain(limb(), limb_tree());
  EXPECT_EQ(body.body().hash(), plain.hash());
  std::vector<std::uint64_t> first;
  for (int excursion = 0; excursion < 2; ++excursion) {
    const std::vector<std::uint64_t> hashes = hashes_of_a_stretch(body);
    if (excursion == 0) first = hashes;
    EXPECT_EQ(hashes, first);
    ASSERT_TRUE(body.update(limb().positions));
    EXPECT_EQ(body.body().hash(), plain.hash());
    std::vector<Vec3f> narrowed;
    for (const Vec3& p : limb().positions) narrowed.emplace_back(p);
    Body narrow(plain);
    ASSERT_TRUE(narrow.update(narrowed));
    ASSERT_TRUE(body.update(narrowed));
    EXPECT_EQ(body.body().hash(), narrow.hash());
  }
}

TEST(LeafFits, are_as_without_after_a_rigid_motion_and_where_nothing_moved) {
  RebuiltBody fitted(limb(), limb_tree(), fitting());
  Body plain(limb(), limb_tree());
  std::size_t rigid = 0;
  for (const test::Motion& motion : test::motions()) {
    const std::string name = motion.name;
    if (!name.starts_with("translation") && !name.starts_with("rotation")) continue;
    const std::vector<Vec3> positions = motion.apply(limb().positions);
    ASSERT_TRUE(fitted.update(positions));
    ASSERT_TRUE(plain.update(positions));
    EXPECT_EQ(fitted.body().hash(), plain.hash()) << name;
    ++rigid;
  }
  EXPECT_GT(rigid, 1u);
}

TEST(LeafFits, copies_fit_as_well_and_follow_parts_and_lazily) {
  RebuiltBody body(limb(), limb_tree(), fitting());
  std::vector<Vec3> positions = stretched_limb(1);
  ASSERT_TRUE(body.update(positions));
  Body whole(body.body()), part(body.body()), lazy(body.body());
  positions[5] += Vec3{0.05, 0.1, -0.1};
  const VertexRange moved[]{{5, 6}};
  ASSERT_TRUE(body.update(positions));
  ASSERT_TRUE(whole.update(positions));
  ASSERT_TRUE(part.update(positions, moved));
  ASSERT_TRUE(lazy.update_lazily(positions, 0));
  for (std::uint32_t node = 0; node < lazy.rest_tree().node_count(); ++node) lazy.refresh_children(node);
  EXPECT_EQ(whole.hash(), body.body().hash());
  EXPECT_EQ(part.hash(), whole.hash());
  EXPECT_EQ(lazy.hash(), whole.hash());
}

TEST(LeafFits, cover_while_every_frame_swaps) {
  test::move_while_trees_change(fitting());
}

TEST(LeafFits, refuse_bad_positions_and_keep_what_was) {
  RebuiltBody body(limb(), limb_tree(), fitting());
  ASSERT_TRUE(body.update(stretched_limb(1)));
  refuse_bad_positions(body, stretched_limb(1));
}

}  // namespace
}  // namespace morula
