// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rays and shapes with masks and lists of ignored bodies, and all hits of a ray, against brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "scene_bodies.hpp"

namespace morula {
namespace {

using test::Crowd;
using test::Thing;

/// Where a ray meets the plane of a facet, and how near to an edge, in shares of the facet's area; no value: outside.
struct SlowHit {
  double t, edge;
};
std::optional<SlowHit> slow_hit(const Triangle& t, const Ray& ray) {
  const Vec3 n = cross(t[1] - t[0], t[2] - t[0]);
  const double slope = dot(n, ray.direction);
  if (slope == 0) return {};
  const double where = dot(n, t[0] - ray.origin) / slope;
  if (where < 0 || where > ray.t_end) return {};
  const Vec3 x = ray.origin + ray.direction * where;
  double edge = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) edge = std::min(edge, dot(n, cross(t[(k + 1) % 3] - t[k], x - t[k])) / dot(n, n));
  if (edge < -1e-9) return {};
  return SlowHit{where, edge};
}

/// A crowd that has come to rest, and random filters of its bodies.
struct Rest {
  explicit Rest(std::uint64_t seed) : crowd(seed) {
    for (int step = 0; step < 10; ++step) crowd.step(scene, false);
    EXPECT_TRUE(scene.update());
  }
  SceneFilter next() {
    ignored.clear();
    for (const auto& thing : crowd.things)
      if (crowd.random.next() % 4 == 0) ignored.push_back(thing->id);
    // Unknown bodies have no effect.
    ignored.push_back({.place = 99, .generation = 1});
    return {.mask = static_cast<std::uint32_t>(crowd.random.next() % 8), .ignored = ignored};
  }
  bool wants(const Thing& thing, const SceneFilter& filter) const {
    return (thing.options.category & filter.mask) != 0 &&
           std::count(filter.ignored.begin(), filter.ignored.end(), thing.id) == 0;
  }
  Crowd crowd;
  Scene scene;
  std::vector<BodyId> ignored;
};

TEST(SceneQuestions, all_hits_of_a_ray_are_those_of_brute_force_over_facets) {
  std::size_t hits = 0, several = 0, left_out = 0;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Rest rest(seed);
    for (int i = 0; i < 1200; ++i) {
      const Ray ray{test::random_point(rest.crowd.random, 3), test::random_point(rest.crowd.random, 1),
                    i % 3 == 0 ? rest.crowd.random.uniform(1, 9) : std::numeric_limits<double>::infinity()};
      const SceneFilter filter = rest.next();
      std::set<std::pair<BodyId, std::uint32_t>> expected;
      bool is_clear = true;
      for (const auto& thing : rest.crowd.things)
        for (std::uint32_t f = 0; f < thing->collider.mesh_facets().size(); ++f) {
          const std::optional<SlowHit> hit = slow_hit(thing->collider.triangle(f), ray);
          if (!hit) continue;
          if (!rest.wants(*thing, filter)) {
            ++left_out;
            continue;
          }
          is_clear = is_clear && hit->edge > 1e-9;
          expected.emplace(thing->id, f);
        }
      if (!is_clear) continue;
      const SceneRayHits all = rest.scene.all_hits(ray, filter);
      ASSERT_TRUE(all.status) << message(all.status);
      EXPECT_TRUE(all.certified);
      std::set<std::pair<BodyId, std::uint32_t>> found;
      for (std::size_t k = 0; k < all.hits.size(); ++k) {
        const auto& [body, hit] = all.hits[k];
        EXPECT_TRUE(found.emplace(body, hit.point.facet).second) << "a facet twice";
        if (k > 0) {
          EXPECT_LE(all.hits[k - 1].hit.t, hit.t);
        }
        const Vec3 there = ray.origin + ray.direction * hit.t;
        EXPECT_LT(distance(hit.point.point, there), 1e-9);
        EXPECT_NEAR(length(hit.normal), 1, 1e-12);
      }
      ASSERT_EQ(found, expected);
      const SceneRayHit first = rest.scene.first_hit(ray, filter);
      ASSERT_EQ(first.first.has_value(), !all.hits.empty());
      if (first.first) {
        EXPECT_EQ(first.body, all.hits[0].body);
        EXPECT_EQ(first.first->t, all.hits[0].hit.t);
        EXPECT_EQ(first.first->point.facet, all.hits[0].hit.point.facet);
      }
      hits += found.size(), several += found.size() > 1;
    }
  }
  EXPECT_GT(hits, 300u);
  EXPECT_GT(several, 50u);
  EXPECT_GT(left_out, 100u);
}

TEST(SceneQuestions, shapes_touch_the_bodies_that_the_filter_leaves) {
  Rest rest(17);
  std::size_t touched = 0, left_out = 0;
  for (int i = 0; i < 200; ++i) {
    const Sphere ball{test::random_point(rest.crowd.random, 2), rest.crowd.random.uniform(0.2, 0.9)};
    const HalfSpace behind{test::random_point(rest.crowd.random, 3), rest.crowd.random.uniform(-3, 1)};
    const SceneFilter filter = rest.next();
    const auto compare = [&](const auto& shape) {
      std::set<BodyId> expected, found;
      for (const auto& thing : rest.crowd.things) {
        if (!touch(thing->collider, shape).touches) continue;
        if (rest.wants(*thing, filter)) {
          expected.insert(thing->id);
        } else {
          ++left_out;
        }
      }
      ASSERT_TRUE(rest.scene.touch(shape, {}, filter));
      for (const SceneTouch& t : rest.scene.touches())
        if (t.touch->touches) found.insert(t.body);
      EXPECT_EQ(found, expected);
      touched += found.size();
    };
    compare(ball), compare(behind), compare(Capsule{ball.center, {}, 0.2});
    compare(ConvexHull::box({ball.center, ball.center + Vec3{0.5, 0.6, 0.7}}));
  }
  EXPECT_GT(touched, 200u);
  EXPECT_GT(left_out, 200u);
}

TEST(SceneQuestions, all_hits_rejects_what_first_hit_rejects) {
  Rest rest(3);
  EXPECT_EQ(rest.scene.all_hits({{}, {}}).status.code, Status::Code::bad_shape);
  Thing& thing = *rest.crowd.things[0];
  thing.collider.set_transform({.translation = {9, 9, 9}});
  rest.scene.wake(thing.id);
  const SceneRayHits stale = rest.scene.all_hits({{}, {1, 0, 0}});
  EXPECT_EQ(stale.status.code, Status::Code::other_frame);
  EXPECT_EQ(stale.status.offender, thing.id);
  EXPECT_TRUE(stale.hits.empty());
}

}  // namespace
}  // namespace morula
