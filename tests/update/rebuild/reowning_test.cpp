// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Patches that change hands: whoever owns what, every piece has one owner, every level covers, and rest is rest.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <morula/collide/contact_query.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/update/rebuilt_body.hpp>

#include "covered_frames.hpp"
#include "limb.hpp"

namespace morula {
namespace {

using namespace test;

constexpr std::size_t plenty = 1'000'000;

RebuildOptions reowning(std::size_t tests = plenty) {
  return {.reown_tests = tests, .thread = RebuildThread::none};
}

// Every piece, as often as it is owned.
std::map<std::vector<std::uint32_t>, int> pieces(const Cover& cover) {
  std::map<std::vector<std::uint32_t>, int> counts;
  for (std::size_t p = 0; p < cover.patch_count(); ++p) {
    const auto corners = cover.patch(p);
    std::vector<std::uint32_t> piece{cover.patch_facet[p]};
    piece.insert(piece.end(), corners.begin(), corners.end());
    ++counts[piece];
  }
  return counts;
}

TEST(Reowning, covers_in_every_frame_and_owns_every_piece_once) {
  std::size_t dealings = 0;
  for (const Specimen& b : test::specimens()) {
    const auto wanted = pieces(b.built.cover);
    RebuiltBody body(b.mesh, b.built, reowning());
    std::uint64_t dealing = 0;
    test::move_a_specimen(b, body, [&](const std::string& where) {
      EXPECT_EQ(validate(body.body().rest_tree(), body.body().cover()), std::vector<std::string>()) << where;
      EXPECT_EQ(pieces(body.body().cover()), wanted) << where;
      dealings += std::exchange(dealing, body.body().pose().dealing) != dealing;
    });
    EXPECT_EQ(body.epoch(), 0u) << b.name;
  }
  EXPECT_GT(dealings, test::motions().size());
}

TEST(Reowning, covers_aligned_and_coarse_bodies_far_from_the_origin) {
  test::move_coarse_bodies(reowning(), [](const RebuiltBody& body, const std::string& name) {
    EXPECT_NE(body.body().pose().dealing, 0u) << name;
  });
}

TEST(Reowning, is_tighter_than_a_fixed_ownership) {
  for (const auto& [motion, at_most] : {std::pair<Deformation, double>{Stretch{2}, 0.6}, {Twist{180}, 0.9}}) {
    RebuiltBody body(limb(), limb_tree(), reowning());
    Body fixed(limb(), limb_tree());
    std::vector<Vec3> positions;
    for (int frame = 1; frame <= 24; ++frame) {
      positions = deform(limb(), {motion}, frame / 24.0);
      ASSERT_TRUE(body.update(positions));
    }
    ASSERT_TRUE(fixed.update(positions));
    const double ours = estimate_looseness(limb(), body.body(), positions).back();
    EXPECT_LT(ours, at_most * estimate_looseness(limb(), fixed, positions).back()) << describe(motion);
  }
}

TEST(Reowning, does_not_make_nodes_above_leaves_reach_farther) {
  RebuiltBody body(limb(), limb_tree(), reowning());
  for (int frame = 1; frame <= 12; ++frame) {
    const std::vector<Vec3> positions = stretched_limb(frame / 12.0);
    Body before(body.body());
    ASSERT_TRUE(before.update(positions));
    ASSERT_TRUE(body.update(positions));
    const SphereTree& tree = body.body().rest_tree();
    for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
      EXPECT_EQ(before.spheres()[node].center, body.body().spheres()[node].center);
      if (tree.is_leaf(node)) continue;
      EXPECT_LE(body.body().spheres()[node].radius, before.spheres()[node].radius) << node;
    }
  }
}

TEST(Reowning, has_the_same_bits_for_any_number_of_workers) {
  std::vector<std::uint64_t> hashes[3];
  for (const unsigned count : {1u, 2u, 3u}) {
    Workers workers(count);
    RebuiltBody body(limb(), limb_tree(), reowning(500));
    for (int frame = 1; frame <= 20; ++frame) {
      ASSERT_TRUE(body.update(deform(limb(), {Twist{180}}, frame / 20.0), workers));
      hashes[count - 1].push_back(body.body().hash());
      hashes[count - 1].push_back(body.body().pose().dealing);
    }
    EXPECT_NE(hashes[count - 1].back(), 0u);
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

TEST(Reowning, returns_to_rest_bit_for_bit_and_goes_on_from_there_as_before) {
  RebuiltBody body(limb(), limb_tree(), reowning());
  const Body plain(limb(), limb_tree());
  std::vector<std::uint64_t> first;
  for (int excursion = 0; excursion < 2; ++excursion) {
    const std::vector<std::uint64_t> hashes = hashes_of_a_stretch(body);
    EXPECT_NE(body.body().pose().dealing, 0u);
    if (excursion == 0) first = hashes;
    EXPECT_EQ(hashes, first);
    ASSERT_TRUE(body.update(limb().positions));
    EXPECT_EQ(body.body().hash(), plain.hash());
    EXPECT_EQ(body.body().pose().dealing, 0u);
    EXPECT_EQ(body.body().cover().patch_facet, limb_tree().cover.patch_facet);
    EXPECT_EQ(body.body().cover().corners, limb_tree().cover.corners);
    EXPECT_EQ(body.body().cover().region_end, limb_tree().cover.region_end);
  }
}

TEST(Reowning, copies_keep_what_they_own_and_follow_parts_and_lazily) {
  const Mesh mesh = sample_body("limb", 40);
  const auto at = [&](double t) { return deform(mesh, {Stretch{2}}, t); };
  RebuiltBody body(mesh, build(mesh, {.depth = 3, .quality = Quality::draft}), reowning());
  for (int frame = 1; frame <= 12; ++frame) ASSERT_TRUE(body.update(at(frame / 12.0)));
  Body whole(body.body()), part(body.body()), lazy(body.body());
  ASSERT_TRUE(body.update(mesh.positions));  // has no say in what they own
  const std::vector<Vec3> before = at(1);
  std::vector<Vec3> positions = before;
  for (std::uint32_t v = 0; v < positions.size(); v += 37) {
    positions = before;
    ASSERT_TRUE(part.update(positions));
    positions[v] += Vec3{0.2, 0.1, -0.3};
    const VertexRange moved[]{{v, v + 1}};
    ASSERT_TRUE(whole.update(positions));
    test::expect_cover(whole, positions, "a copy");
    ASSERT_TRUE(part.update(positions, moved));
    EXPECT_EQ(part.hash(), whole.hash());
  }
  ASSERT_TRUE(lazy.update_lazily(positions, 0));
  for (std::uint32_t node = 0; node < lazy.rest_tree().node_count(); ++node) lazy.reach(node);
  EXPECT_EQ(lazy.hash(), whole.hash());
}

TEST(Reowning, refuses_bad_positions_and_keeps_what_was) {
  RebuiltBody body(limb(), limb_tree(), reowning());
  for (int frame = 1; frame <= 6; ++frame) ASSERT_TRUE(body.update(stretched_limb(frame / 6.0)));
  refuse_bad_positions(body, stretched_limb(1));
  test::expect_cover(body.body(), stretched_limb(1), "after a refusal");
}

TEST(Reowning, covers_while_every_frame_swaps) {
  test::move_while_trees_change(reowning());
}

class ReowningContacts : public testing::Test {
 protected:
  RebuiltBody body{limb(), limb_tree(), reowning()};
  Body other{limb(), limb_tree()};
  Collider b{limb(), other};
  std::vector<Vec3> positions;

  void SetUp() override {
    RigidTransform placement;
    placement.translation = {0.3, 0.15, 0.1};
    b.place(placement);
  }
  void next(int frame) {
    positions = stretched_limb(frame / 12.0);
    ASSERT_TRUE(body.update(positions));
  }
};

TEST_F(ReowningContacts, refuse_facets_of_owners_before) {
  Collider a(limb(), body.body());
  next(6);
  ASSERT_NE(body.body().pose().dealing, 0u);
  EXPECT_EQ(askable(a).code, Status::Code::ownership_not_current);
  EXPECT_THROW(crossings(a, b), std::invalid_argument);
  a.follow_ownership();
  EXPECT_TRUE(askable(a));
  const Collider fresh(limb(), body.body());
  for (std::uint32_t node = 0; node < a.tree().node_count(); ++node)
    EXPECT_TRUE(std::ranges::equal(a.facets(node), fresh.facets(node))) << node;
}

TEST_F(ReowningContacts, find_all_that_crosses) {
  Collider a(limb(), body.body());
  SurfaceTree surface_a(limb()), surface_b(limb());
  std::size_t found = 0;
  for (int frame = 1; frame <= 12; frame += 2) {
    next(frame);
    a.follow_ownership();
    for (const Vec3& where : {Vec3{0.3, 0.15, 0.1}, Vec3{0.05, 0.3, 0.02}, Vec3{-0.6, 0.02, 0.25}}) {
      RigidTransform placement;
      placement.translation = where;
      b.place(placement);
      const std::vector<Crossing> all = crossings(a, b);
      EXPECT_EQ(all, brute_force::crossings(a, b)) << "frame " << frame;
      ASSERT_TRUE(surface_a.follow(a));
      ASSERT_TRUE(surface_b.follow(b));
      SurfaceCrossingQuery query;
      ASSERT_TRUE(query.run(surface_a, surface_b).finished);
      EXPECT_EQ(query.pairs().size(), all.size()) << "frame " << frame;
      found += all.size();
    }
  }
  EXPECT_GT(found, 0u);
}

TEST_F(ReowningContacts, carry_their_front_and_have_the_surfaces_of_a_fresh_query) {
  Collider a(limb(), body.body());
  ContactQuery carried({.surfaces = true});
  carried.add(a, b);
  ASSERT_TRUE(carried.start());
  std::size_t contacts = 0;
  for (int frame = 1; frame <= 12; ++frame) {
    next(frame);
    a.follow_ownership();
    const ContactStatus status = carried.carry();
    ASSERT_TRUE(status) << message(status);
    const Collider fresh_a(limb(), body.body());
    ContactQuery fresh({.surfaces = true});
    fresh.add(fresh_a, b);
    ASSERT_TRUE(fresh.start());
    const auto by_nodes = [](const ContactQuery& query) {
      const Contacts& all = query.contacts();
      std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<Vec3, double>> found;
      for (std::size_t i = 0; i < all.contacts.size(); ++i)
        found[{all.contacts[i].node_a, all.contacts[i].node_b}] = {all.surfaces[i].normal, all.surfaces[i].depth};
      return found;
    };
    EXPECT_EQ(by_nodes(carried), by_nodes(fresh)) << "frame " << frame;
    contacts += fresh.contacts().contacts.size();
  }
  EXPECT_GT(contacts, 0u);
}

}  // namespace
}  // namespace morula
