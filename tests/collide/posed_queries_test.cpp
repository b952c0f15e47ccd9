// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries of pairs, and of bodies that are updated, copied and asked in turn: the same answers from vertices that a
// body computes when they are read as over given ones.
#include <gtest/gtest.h>

#include <morula/collide/contact_patches.hpp>
#include <morula/collide/contacts.hpp>
#include <morula/collide/containment.hpp>
#include <morula/collide/crossings.hpp>
#include <morula/collide/distance.hpp>
#include <morula/collide/penetration.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/collide/sweep.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/scene/scene.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/surface_tree.hpp>
#include <support/numbers.hpp>

#include "posed_bodies.hpp"

namespace morula {
namespace {

using test::below;
using test::posed_limb;
using test::PosedBody;
using test::random_pose;
using test::random_ray;
using test::same;
using test::same_bits;
using test::Transforms;

void expect_same_contacts(const Contacts& a, const Contacts& b) {
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (std::size_t i = 0; i < a.surfaces.size(); ++i) {
    EXPECT_TRUE(same(a.surfaces[i].on_a, b.surfaces[i].on_a) && same(a.surfaces[i].on_b, b.surfaces[i].on_b));
    EXPECT_EQ(a.surfaces[i].normal, b.surfaces[i].normal);
    EXPECT_EQ(a.surfaces[i].depth, b.surfaces[i].depth);
  }
  ASSERT_EQ(a.crossings.size(), b.crossings.size());
  for (std::size_t i = 0; i < a.crossings.size(); ++i) {
    EXPECT_EQ(a.crossings[i].facet_a, b.crossings[i].facet_a);
    EXPECT_EQ(a.crossings[i].facet_b, b.crossings[i].facet_b);
  }
  ASSERT_EQ(a.containment.size(), b.containment.size());
  for (std::size_t i = 0; i < a.containment.size(); ++i) {
    EXPECT_EQ(a.containment[i].a_in_b.inside, b.containment[i].a_in_b.inside);
    EXPECT_EQ(a.containment[i].b_in_a.inside, b.containment[i].b_in_a.inside);
  }
}

void expect_same_distance(const DistanceBounds& a, const DistanceBounds& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_TRUE(same(a.a, b.a) && same(a.b, b.b));
}

// All queries of a pair, against the same over given positions.
void expect_same_answers(const Collider& a, const Collider& b, const Collider& given_a, const Collider& given_b) {
  const CollideOptions options{.surfaces = true, .find_crossings = true, .containment = true};
  expect_same_contacts(collide(a, b, options), collide(given_a, given_b, options));
  EXPECT_EQ(overlap(a, b), overlap(given_a, given_b));
  expect_same_distance(distance(a, b), distance(given_a, given_b));
  const auto patches = [](const Collider& x, const Collider& y) {
    ContactPatchQuery query(x, y);
    EXPECT_TRUE(query.run());
    return query.volume();
  };
  EXPECT_EQ(patches(a, b), patches(given_a, given_b));
  const PenetrationOptions roughly{.budget = Budget{500}};
  const Penetration shared = PenetrationQuery(a, b).run(roughly);
  const Penetration shared_given = PenetrationQuery(given_a, given_b).run(roughly);
  EXPECT_EQ(shared.lower, shared_given.lower);
  EXPECT_EQ(shared.upper, shared_given.upper);
  const Sphere ball{{0.2, 0.1, 0}, 0.6};
  const Touch touched = touch(a, ball, {.nearest = true}), expected = touch(given_a, ball, {.nearest = true});
  ASSERT_TRUE(touched.deepest && expected.deepest);
  EXPECT_TRUE(same(touched.deepest->point, expected.deepest->point));
  const SweepHit swept = sweep(a, Sphere{{-4, 0.1, 0}, 0.1}, {8, 0, 0});
  const SweepHit swept_given = sweep(given_a, Sphere{{-4, 0.1, 0}, 0.1}, {8, 0, 0});
  ASSERT_EQ(swept.first.has_value(), swept_given.first.has_value());
  if (swept.first) {
    EXPECT_EQ(swept.first->t, swept_given.first->t);
  }
}

TEST(PosedQueries, of_pairs_answer_as_over_given_positions) {
  Random random(5);
  PosedBody& a = posed_limb();
  PosedBody b(sample_body("torus", 12), 7);
  for (int frame = 0; frame < 8; ++frame) {
    a.pose(random_pose(random, 24, 0.1));
    b.pose(random_pose(random, 7, 0.1));
    const RigidTransform at = test::random_transform(random, frame % 2 == 0 ? 0.5 : 3.0);
    b.collider.set_transform(at);
    b.given.set_transform(at);
    expect_same_answers(a.collider, b.collider, a.given, b.given);  // both skinned
    expect_same_answers(a.collider, b.given, a.given, b.given);     // one of them
    expect_same_answers(b.given, a.collider, b.given, a.given);
  }
}

TEST(PosedQueries, of_scenes_and_surface_trees_answer_as_over_given_positions) {
  Random random(12);
  PosedBody& a = posed_limb();
  PosedBody b(sample_body("torus", 12), 7);
  b.collider.set_transform({.translation = {0.3, 0.2, 0.1}});
  b.given.set_transform({.translation = {0.3, 0.2, 0.1}});
  Scene scene({.surfaces = true, .find_crossings = true}), scene_given({.surfaces = true, .find_crossings = true});
  const BodyId first = scene.add(a.collider), second = scene.add(b.collider);
  const BodyId first_given = scene_given.add(a.given), second_given = scene_given.add(b.given);
  SurfaceTree tree_a(a.mesh), tree_b(b.mesh);
  SurfaceCrossingQuery query;
  std::size_t found = 0;
  for (int frame = 0; frame < 4; ++frame) {
    a.pose(random_pose(random, 24, 0.1));
    b.pose(random_pose(random, 7, 0.1));
    ASSERT_TRUE(scene.update() && scene_given.update());
    const ScenePair* const pair = scene.find(first, second);
    const ScenePair* const expected = scene_given.find(first_given, second_given);
    ASSERT_TRUE(pair != nullptr && expected != nullptr);
    ASSERT_EQ(pair->crossings.size(), expected->crossings.size());
    for (std::size_t i = 0; i < pair->crossings.size(); ++i)
      EXPECT_EQ(pair->crossings[i].facet_a, expected->crossings[i].facet_a);
    found += pair->crossings.size();
    for (int i = 0; i < 20; ++i) {
      const Ray ray = random_ray(random);
      EXPECT_TRUE(same(scene.first_hit(ray).first, scene_given.first_hit(ray).first));
    }
    ASSERT_TRUE(tree_a.follow(a.collider));
    ASSERT_TRUE(tree_b.follow(b.collider));
    ASSERT_TRUE(query.run(tree_a, tree_b));
    EXPECT_EQ(query.pairs().size(), crossings(a.given, b.given).size());
  }
  EXPECT_GT(found, 0u);
}

TEST(PosedQueries, follow_updates_rejections_copies_and_queries_in_any_order) {
  Random random(6);
  PosedBody& posed = posed_limb();
  posed.pose(random_pose(random, 24, 0.3));
  DistanceQuery distances, distances_given;
  PosedBody other(sample_body("torus", 10), 5);
  InsideQuery inside(posed.collider), inside_given(posed.given);
  const auto ask = [&] {
    for (int i = 0; i < 8; ++i) {
      const Ray ray = random_ray(random);
      EXPECT_TRUE(same(first_hit(posed.collider, ray).first, first_hit(posed.given, ray).first));
      EXPECT_EQ(inside.locate(ray.direction).winding, inside_given.locate(ray.direction).winding);
    }
    expect_same_distance(distances.run(posed.collider, other.collider), distances_given.run(posed.given, other.given));
  };
  for (int step = 0; step < 120; ++step) switch (below(random, 6)) {
      case 0:
        posed.pose(random_pose(random, 24, 0.3));
        break;
      case 1:
        other.pose(random_pose(random, 5, 0.2));
        break;
      case 2: {  // A rejected update: queries refuse the body, whose positions stay, until the next good one.
        Transforms bad = posed.transforms;
        bad[below(random, 24)].columns[1].z = test::nan;
        ASSERT_FALSE(posed.body.update_skinned(bad));
        EXPECT_EQ(RayQuery().run(posed.collider, random_ray(random)).status.code, Status::Code::body_not_current);
        EXPECT_TRUE(same_bits(posed.collider.positions(), posed.positions));
        posed.pose(posed.transforms);
        break;
      }
      case 3: {  // A copy keeps its frame while the original goes on, and the other way around.
        Body copy = posed.body;
        const Collider of_copy(posed.mesh, copy);
        const std::vector<Vec3> before = posed.positions;
        if (below(random, 2) == 0) {
          EXPECT_TRUE(same_bits(of_copy.positions(), before));
        }
        posed.pose(random_pose(random, 24, 0.3));
        ask();
        EXPECT_TRUE(same_bits(of_copy.positions(), before));
        ASSERT_TRUE(copy.update_skinned(posed.transforms));
        EXPECT_TRUE(same_bits(of_copy.positions(), posed.positions));
        break;
      }
      case 4:
        EXPECT_TRUE(same_bits(posed.collider.positions(), posed.positions));
        break;
      default:
        ask();
    }
}

}  // namespace
}  // namespace morula
