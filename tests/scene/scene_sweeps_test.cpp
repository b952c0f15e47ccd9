// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Moving shapes and nearest bodies in a scene, with filters, against each body by itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <morula/collide/contact_query.hpp>
#include <optional>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using test::Crowd;
using test::Thing;

double to_triangle(const Vec3& x, const Triangle& t) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  double least = std::numeric_limits<double>::infinity();
  bool is_above = dot(n, n) > 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &p = t[k], &q = t[(k + 1) % 3];
    const double s = std::clamp(dot(x - p, q - p) / std::max(dot(q - p, q - p), 1e-300), 0.0, 1.0);
    least = std::min(least, length(x - (p + (q - p) * s)));
    is_above = is_above && dot(cross(q - p, x - p), n) >= 0;
  }
  return is_above ? std::abs(dot(n, x - t[0])) / length(n) : least;
}
double to_body(const Vec3& x, const Collider& body) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t f = 0; f < body.mesh_facets().size(); ++f)
    least = std::min(least, to_triangle(x, body.triangle(f)));
  return least;
}

/// The first time at which a ball is at a body, by steps as long as the distance left; no value: it passes.
std::optional<double> time_by_steps(const Sphere& ball, const Vec3& motion, const Collider& body) {
  for (double t = 0; t <= 1;) {
    const double left = to_body(ball.center + motion * t, body) - ball.radius;
    if (left < 1e-10) return t;
    t += left / length(motion);
  }
  return {};
}

bool is_wanted(const Thing& thing, const SceneFilter& filter) {
  return (thing.options.category & filter.mask) != 0 &&
         std::count(filter.ignored.begin(), filter.ignored.end(), thing.id) == 0;
}

TEST(SceneSweeps, find_the_bodies_and_times_that_steps_of_the_distance_find) {
  std::size_t found = 0, several = 0, passed = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Crowd crowd(seed);
    Scene scene;
    for (int step = 0; step < 10; ++step) crowd.step(scene, false);
    ASSERT_TRUE(scene.update());
    for (int i = 0; i < 120; ++i) {
      const Sphere ball{test::random_point(crowd.random, 3), crowd.random.uniform(0.02, 0.4)};
      const Vec3 motion = test::random_point(crowd.random, 4);
      std::vector<BodyId> ignored;
      for (const auto& thing : crowd.things)
        if (crowd.random.next() % 5 == 0) ignored.push_back(thing->id);
      const SceneFilter filter{.mask = static_cast<std::uint32_t>(crowd.random.next() % 7 + 1), .ignored = ignored};
      std::map<BodyId, double> expected;
      for (const auto& thing : crowd.things)
        if (const auto time = time_by_steps(ball, motion, thing->collider)) {
          if (is_wanted(*thing, filter)) {
            expected[thing->id] = *time;
          } else {
            ++left_out;
          }
        }
      const SceneSweepHits all = scene.sweep_all(ball, motion, filter);
      ASSERT_TRUE(all.status) << message(all.status);
      EXPECT_TRUE(all.certified);
      ASSERT_EQ(all.hits.size(), expected.size());
      for (std::size_t k = 0; k < all.hits.size(); ++k) {
        const SceneSweep& hit = all.hits[k];
        ASSERT_EQ(expected.count(hit.body), 1u);
        EXPECT_NEAR(hit.first.t, expected[hit.body], 1e-6);
        if (k > 0) {
          EXPECT_LE(all.hits[k - 1].first.t, hit.first.t);
        }
        EXPECT_NEAR(distance(hit.first.point.point, ball.center + motion * hit.first.t), ball.radius,
                    hit.first.t > 0 ? 1e-9 : ball.radius);
      }
      const SceneSweepHit first = scene.sweep(ball, motion, filter);
      ASSERT_TRUE(first.status);
      ASSERT_EQ(first.body.has_value(), !all.hits.empty());
      if (first.body) {
        EXPECT_EQ(*first.body, all.hits[0].body);
        EXPECT_EQ(first.first->t, all.hits[0].first.t);
      }
      found += all.hits.size(), several += all.hits.size() > 1, passed += all.hits.empty();
    }
  }
  EXPECT_GT(found, 40u);
  EXPECT_GT(several, 10u);
  EXPECT_GT(passed, 5u);
  EXPECT_GT(left_out, 50u);
}

// Long and thin on a slanted way, where boxes about the whole way are of no use.
TEST(SceneSweeps, capsules_and_boxes_find_in_the_scene_what_they_find_at_each_body) {
  Crowd crowd(5);
  Scene scene;
  for (int step = 0; step < 10; ++step) crowd.step(scene, false);
  ASSERT_TRUE(scene.update());
  std::size_t found = 0;
  const auto compare = [&](const auto& shape, const Vec3& motion) {
    std::vector<std::pair<double, BodyId>> expected;
    for (const auto& thing : crowd.things)
      if (const SweepHit hit = sweep(thing->collider, shape, motion); hit.first)
        expected.emplace_back(hit.first->t, thing->id);
    std::sort(expected.begin(), expected.end());
    const SceneSweepHits all = scene.sweep_all(shape, motion);
    ASSERT_TRUE(all.status) << message(all.status);
    ASSERT_EQ(all.hits.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k)
      EXPECT_EQ(std::pair(all.hits[k].first.t, all.hits[k].body), expected[k]);
    found += expected.size();
  };
  for (int i = 0; i < 60; ++i) {
    const Vec3 at = test::random_point(crowd.random, 3), motion = test::random_point(crowd.random, 5);
    compare(Capsule{at, at + test::random_point(crowd.random, 1), 0.05}, motion);
    compare(ConvexHull::box({{-0.6, -0.02, -0.02}, {0.6, 0.02, 0.02}}, test::random_transform(crowd.random, 0, at)),
            motion);
  }
  EXPECT_GT(found, 60u);
}

TEST(SceneSweeps, reject_what_rays_reject) {
  Crowd crowd(3);
  Scene scene;
  for (int step = 0; step < 10; ++step) crowd.step(scene, false);
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.sweep(Sphere{{}, -1}, {1, 0, 0}).status.code, Status::Code::bad_shape);
  EXPECT_EQ(scene.sweep_all(Sphere{{}, 1}, {0, 0, std::nan("")}).status.code, Status::Code::bad_shape);
  Thing& thing = *crowd.things[0];
  thing.collider.set_transform({.translation = {9, 9, 9}});
  scene.wake(thing.id);
  const SceneSweepHits stale = scene.sweep_all(Sphere{{}, 1}, {1, 0, 0});
  EXPECT_EQ(stale.status.code, Status::Code::other_frame);
  EXPECT_EQ(stale.status.offender, thing.id);
}

TEST(SceneNearest, is_the_body_whose_facets_are_nearest) {
  Crowd crowd(7);
  Scene scene;
  for (int step = 0; step < 10; ++step) crowd.step(scene, false);
  ASSERT_TRUE(scene.update());
  std::size_t apart = 0, touching = 0;
  for (int i = 0; i < 200; ++i) {
    const Sphere ball{test::random_point(crowd.random, i % 2 == 0 ? 2 : 30), 0.1};
    const SceneFilter filter{.mask = static_cast<std::uint32_t>(crowd.random.next() % 7 + 1)};
    double least = std::numeric_limits<double>::infinity();
    BodyId nearest{};
    std::size_t within = 0, wanted = 0;
    for (const auto& thing : crowd.things) {
      if (!is_wanted(*thing, filter)) continue;
      ++wanted;
      const double gap = to_body(ball.center, thing->collider) - ball.radius;
      within += gap <= 0;
      if (gap < least) least = gap, nearest = thing->id;
    }
    ASSERT_TRUE(scene.touch(ball, {.nearest = true}, filter));
    if (wanted == 0) {
      EXPECT_TRUE(scene.touches().empty());
      continue;
    }
    ASSERT_EQ(scene.touches().size(), std::max<std::size_t>(within, 1));
    const auto found = std::find_if(scene.touches().begin(), scene.touches().end(),
                                    [&](const SceneTouch& touch) { return touch.body == nearest; });
    ASSERT_NE(found, scene.touches().end());
    EXPECT_NEAR(found->touch->deepest->depth, -least, 1e-9);
    (within > 0 ? touching : apart) += 1;
  }
  EXPECT_GT(apart, 20u);
  EXPECT_GT(touching, 10u);
  // Equal distances: the lowest place.
  Thing left(test::icosphere(1, 0.6)), right(test::icosphere(1, 0.6));
  left.collider.set_transform({.translation = {0, 0, -4}}), right.collider.set_transform({.translation = {0, 0, 4}});
  for (const bool swapped : {false, true}) {
    Scene two;
    const BodyId first = two.add(swapped ? right.collider : left.collider);
    two.add(swapped ? left.collider : right.collider);
    ASSERT_TRUE(two.update());
    ASSERT_TRUE(two.touch(HalfSpace{{1, 0, 0}, -9}, {.nearest = true}));
    ASSERT_EQ(two.touches().size(), 1u);
    EXPECT_EQ(two.touches()[0].body, first);
  }
}

// The scene and the query share the state of a collider, wherever its owner puts it.
TEST(Scene, follows_colliders_that_are_moved_in_memory_and_keeps_temporary_ones) {
  const Mesh mesh = test::icosphere(1, 0.6);
  const CoveredTree model = build(mesh, {.method = Method::octree, .branching = 8, .depth = 2});
  const Body body(mesh, model), other(mesh, model);
  Scene scene;
  ContactQuery query;
  std::vector<Collider> colliders;
  std::vector<BodyId> ids;
  for (int i = 0; i < 40; ++i) {  // the vector grows
    colliders.emplace_back(mesh, body);
    ids.push_back(scene.add(colliders.back()));
  }
  for (std::size_t i = 0; i < colliders.size(); ++i)
    colliders[i].set_transform({.translation = {10.0 * static_cast<double>(i), 0, 0}});
  const BodyId temporary = scene.add(Collider(mesh, other));
  query.add(colliders[0], Collider(mesh, other));
  std::vector<Collider> elsewhere = std::move(colliders);
  elsewhere.reserve(1000);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u) << "the temporary one is where the first is";
  EXPECT_EQ(scene.pairs()[0].a, ids[0]);
  EXPECT_EQ(scene.pairs()[0].b, temporary);
  ASSERT_TRUE(query.run());
  EXPECT_EQ(query.contacts().contacts.size(), scene.pairs()[0].contacts.size());
  EXPECT_EQ(scene.collider(ids[3]).transform(), elsewhere[3].transform());
  // A query of the scene's own view of a collider outlives the body's place in the scene.
  ContactQuery of_scene;
  of_scene.add(scene.collider(temporary), scene.collider(ids[0]));
  scene.remove(temporary);
  elsewhere[5].set_transform({.translation = {10.0 * 4 + 0.3, 0, 0}});
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_EQ(scene.pairs()[0].a, ids[4]);
  ASSERT_TRUE(of_scene.run());
  EXPECT_GT(of_scene.contacts().contacts.size(), 0u);
  // Assignment gives the side another body, which the scene sees.
  elsewhere[5] = Collider(mesh, other);
  ASSERT_TRUE(scene.update());
  ASSERT_EQ(scene.pairs().size(), 1u);
  EXPECT_EQ(scene.pairs()[0].a, ids[0]);
  // A copy is another side.
  Collider copy = elsewhere[7];
  copy.set_transform({});
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs().size(), 1u);
  // Colliders that are gone leave their state behind.
  elsewhere.clear();
  ASSERT_TRUE(scene.update());
  EXPECT_EQ(scene.pairs().size(), 1u);
}

}  // namespace
}  // namespace morula
