// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Queries on facets of bodies that follow bones or modes alone: the body computes vertices when they are read. Judged
// by brute force over positions from the definition of a skin, and by the same queries over given positions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/collide/containment.hpp>
#include <morula/collide/primitives.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/update/modes.hpp>
#include <morula/update/skin_morphs.hpp>
#include <numbers>
#include <numeric>
#include <optional>
#include <support/allocations.hpp>
#include <support/numbers.hpp>
#include <thread>

#include "posed_bodies.hpp"

namespace morula {
namespace {

using test::below;
using test::posed_limb;
using test::PosedBody;
using test::random_point;
using test::random_pose;
using test::random_ray;
using test::same;
using test::same_bits;
using test::Transforms;

TEST(PosedVertices, have_the_bits_of_move_by_skin_in_any_order_of_reading) {
  Random random(1);
  PosedBody& posed = posed_limb();
  for (int frame = 0; frame < 12; ++frame) {
    posed.pose(frame == 5 ? Transforms(24) : random_pose(random, 24, 0.4));
    ASSERT_FALSE(posed.body.sphere_state().positions);
    ASSERT_TRUE(posed.collider.has_current_positions());
    const std::vector<Vec3> defined = test::defined_positions(posed.skin, posed.mesh.positions, posed.transforms);
    if (frame % 3 == 1) {
      EXPECT_TRUE(same_bits(posed.collider.positions(), posed.positions)) << frame;
    }
    for (int i = 0; i < 200; ++i) {
      const auto v = static_cast<std::uint32_t>(below(random, posed.mesh.vertex_count()));
      EXPECT_EQ(posed.collider.vertex(v), posed.positions[v]) << frame;
      EXPECT_LE(distance(posed.collider.vertex(v), defined[v]), 1e-14) << frame;
    }
    if (frame % 3 == 2) {
      EXPECT_TRUE(same_bits(posed.collider.positions(), posed.positions)) << frame;
    }
  }
}

// Least t over all facets; nearest_edge: how far from all edges the ray stays.
double slow_first_hit(const std::vector<Facet>& facets, const std::vector<Vec3>& p, const Ray& ray,
                      double* nearest_edge) {
  double first = *nearest_edge = std::numeric_limits<double>::infinity();
  for (const Facet& f : facets) {
    const Triangle t{p[f[0]], p[f[1]], p[f[2]]};
    const Vec3 n = area_vector(t);
    const double slope = dot(n, ray.direction);
    double inside = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 side = cross(ray.direction, t[(k + 1) % 3] - t[k]);
      const double size = length(side);
      const double offset = size > 0 ? dot(side, t[k] - ray.origin) / size * (slope > 0 ? -1 : 1) : 0;
      inside = std::min(inside, offset);
      *nearest_edge = std::min(*nearest_edge, std::abs(offset));
    }
    const double where = slope != 0 ? dot(n, t[0] - ray.origin) / slope : -1;
    if (inside >= 0 && where >= 0) first = std::min(first, where);
  }
  return first;
}

TEST(PosedVertices, rays_hit_like_brute_force_over_the_skins_definition) {
  Random random(2);
  PosedBody& posed = posed_limb();
  std::size_t hits = 0, misses = 0;
  for (int frame = 0; frame < 10; ++frame) {
    posed.pose(random_pose(random, 24, 0.3));
    const std::vector<Vec3> defined = test::defined_positions(posed.skin, posed.mesh.positions, posed.transforms);
    for (int i = 0; i < 60; ++i) {
      const Ray ray = random_ray(random);
      double nearest_edge = 0;
      const double expected = slow_first_hit(posed.mesh.facets, defined, ray, &nearest_edge);
      if (nearest_edge < 1e-9) continue;
      const RayHit found = first_hit(posed.collider, ray);
      ASSERT_TRUE(found.certified);
      ASSERT_EQ(found.first.has_value(), std::isfinite(expected)) << frame << ' ' << i;
      ++(found.first ? hits : misses);
      if (found.first) {
        EXPECT_NEAR(found.first->t, expected, 1e-9) << frame << ' ' << i;
      }
    }
  }
  EXPECT_GT(hits, 100u);
  EXPECT_GT(misses, 50u);
}

TEST(PosedVertices, rays_through_corners_and_along_edges_hit_as_over_given_positions) {
  Random random(3);
  PosedBody& posed = posed_limb();
  std::vector<RayPoint> all, all_given;
  std::size_t hits = 0;
  for (int frame = 0; frame < 5; ++frame) {
    posed.pose(random_pose(random, 24, 0.3));
    for (int i = 0; i < 60; ++i) {
      const Facet& f = posed.mesh.facets[below(random, posed.mesh.facet_count())];
      const Vec3 &p = posed.positions[f[0]], &q = posed.positions[f[1]];
      Ray ray{random_point(random, 4.0), {}};
      if (i % 3 == 0) ray.direction = p - ray.origin;  // through a corner
      if (i % 3 == 1) ray.direction = (p + q) * 0.5 - ray.origin;
      if (i % 3 == 2) ray = {p - (q - p) * 4.0, q - p};  // along an edge
      const RayHit found = RayQuery().run_all(posed.collider, ray, all);
      static_cast<void>(RayQuery().run_all(posed.given, ray, all_given));
      ASSERT_EQ(all.size(), all_given.size());
      for (std::size_t k = 0; k < all.size(); ++k) EXPECT_TRUE(same(all[k], all_given[k]));
      EXPECT_TRUE(same(found.first, first_hit(posed.given, ray).first));
      hits += found.first ? 1 : 0;
    }
  }
  EXPECT_GT(hits, 150u);
}

TEST(PosedVertices, inside_is_where_solid_angles_wind_around_the_point) {
  Random random(4);
  PosedBody& posed = posed_limb();
  InsideQuery query(posed.collider);  // made before the frames that it is asked about
  std::size_t inside = 0, outside = 0;
  for (int frame = 0; frame < 6; ++frame) {
    posed.pose(random_pose(random, 24, 0.15));
    const std::vector<Vec3> defined = test::defined_positions(posed.skin, posed.mesh.positions, posed.transforms);
    for (int i = 0; i < 40; ++i) {
      const Vec3 p = defined[below(random, defined.size())] + random_point(random, 0.4);
      double angles = 0;
      for (const Facet& f : posed.mesh.facets) angles += solid_angle({defined[f[0]], defined[f[1]], defined[f[2]]}, p);
      const double winding = angles / (4 * std::numbers::pi);
      if (std::abs(winding - std::round(winding)) > 1e-6) continue;
      const PointLocation found = query.locate(p);
      ASSERT_TRUE(found.status && found.certified);
      EXPECT_EQ(found.winding, static_cast<int>(std::lround(winding)));
      EXPECT_EQ(found.inside, std::lround(winding) != 0);
      ++(found.inside ? inside : outside);
    }
  }
  EXPECT_GT(inside, 30u);
  EXPECT_GT(outside, 30u);
}

TEST(PosedVertices, a_moved_body_keeps_them_and_an_assigned_one_is_refused) {
  Random random(7);
  PosedBody posed(sample_body("limb", 8), 24);
  posed.pose(random_pose(random, 24, 0.3));
  Body moved = std::move(posed.body);
  EXPECT_TRUE(same_bits(posed.collider.positions(), posed.positions));
  ASSERT_TRUE(RayQuery().run(posed.collider, random_ray(random)).status);
  const Body another = moved;
  moved = another;
  EXPECT_EQ(RayQuery().run(posed.collider, random_ray(random)).status.code, Status::Code::body_replaced);
  EXPECT_TRUE(same_bits(Collider(posed.mesh, moved).positions(), posed.positions));
}

TEST(PosedVertices, at_rest_are_those_of_the_mesh_and_copies_of_states_have_none) {
  PosedBody posed(sample_body("limb", 8), 24);
  EXPECT_TRUE(same_bits(posed.collider.positions(), posed.mesh.positions));
  const Body copy = posed.body;
  EXPECT_TRUE(same_bits(Collider(posed.mesh, copy).positions(), posed.mesh.positions));
  Transforms bad(24);
  bad[3].translation.x = test::infinity;
  ASSERT_FALSE(posed.body.update_skinned(bad));
  EXPECT_TRUE(same_bits(posed.collider.positions(), posed.mesh.positions));
  Random random(8);
  posed.pose(random_pose(random, 24, 0.3));
  const PosedSpheres spheres(posed.body.sphere_state());
  EXPECT_FALSE(Collider(posed.mesh, posed.body.cover(), spheres.sphere_state()).has_current_positions());
}

TEST(PosedVertices, allocate_at_the_first_read_of_a_body_alone) {
  Random random(9);
  PosedBody& posed = posed_limb();
  posed.pose(random_pose(random, 24, 0.3));
  const Transforms next = random_pose(random, 24, 0.3);
  const Ray ray = random_ray(random);
  const RayQuery query;
  Body copy = posed.body;
  const Collider of_copy(posed.mesh, copy);
  EXPECT_EQ(of_copy.vertex(0), posed.collider.vertex(0));  // the first read of a body allocates
  const std::size_t before = test::allocations;
  bool good = static_cast<bool>(posed.body.update_skinned(next)) && static_cast<bool>(copy.update_skinned(next));
  good = good && query.run(posed.collider, ray).status && query.run(of_copy, ray).status;
  const Vec3 last = of_copy.positions()[0];
  EXPECT_EQ(test::allocations, before);
  EXPECT_TRUE(good && is_finite(last));
}

TEST(PosedVertices, of_modes_have_the_bits_of_move_by_modes) {
  Random random(10);
  const Mesh mesh = sample_body("limb", 12);
  const CoveredTree model = build(mesh, {.method = Method::octree, .branching = 8, .depth = 3});
  Modes modes{mesh.vertex_count(), 3, {}};
  for (std::size_t i = 0; i < 3 * mesh.vertex_count(); ++i) modes.displacements.push_back(random_point(random, 0.05));
  Body body(mesh, model, {.rules = {Rule::modal}, .modes = modes});
  const Collider collider(mesh, body);
  Collider given(mesh, body);
  std::vector<Vec3> positions(mesh.vertex_count());
  for (int frame = 0; frame < 9; ++frame) {
    const std::vector<double> q{random.uniform(-1, 1), frame % 2 == 0 ? 0.0 : random.uniform(-1, 1), 0.5};
    const std::size_t level = frame % 3 == 2 ? 1 : 3;
    ASSERT_TRUE(frame % 3 == 0 ? body.update_modal(q) : body.update_modal_lazily(q, level));
    for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node) body.refresh_children(node);
    move_by_modes(modes, mesh.positions, q, positions);
    given.set_positions(positions);
    for (int i = 0; i < 20; ++i) {
      const Ray ray = random_ray(random);
      EXPECT_TRUE(same(first_hit(collider, ray).first, first_hit(given, ray).first));
    }
    EXPECT_TRUE(same_bits(collider.positions(), positions));
  }
}

TEST(PosedVertices, of_morph_targets_and_bones_have_the_bits_of_move_by_skin) {
  Random random(13);
  const PosedBody& limb = posed_limb();
  Modes modes{limb.mesh.vertex_count(), 3, {}};
  for (std::size_t i = 0; i < 3 * limb.mesh.vertex_count(); ++i)
    modes.displacements.push_back(random_point(random, 0.05));
  Body body(limb.mesh, limb.model, {.rules = {Rule::skinned}, .modes = modes, .skin = limb.skin});
  const Collider collider(limb.mesh, body);
  std::vector<Vec3> positions(limb.mesh.vertex_count());
  for (int frame = 0; frame < 6; ++frame) {
    const Transforms transforms = random_pose(random, 24, 0.3);
    const std::vector<double> morphs{random.uniform(-1, 1), frame % 2 == 0 ? 0.0 : 0.7, random.uniform(-1, 1)};
    const bool morphed = frame % 3 != 2;  // without morphs, those of the frame before are gone
    ASSERT_TRUE(morphed ? body.update_skinned(transforms, morphs) : body.update_skinned(transforms));
    const std::vector<double> used = morphed ? morphs : std::vector<double>(3);
    move_by_skin(limb.skin, modes, limb.mesh.positions, transforms, used, positions);
    EXPECT_EQ(collider.vertex(static_cast<std::uint32_t>(frame)), positions[static_cast<std::size_t>(frame)]);
    const Body copy = body;
    EXPECT_TRUE(same_bits(collider.positions(), positions));
    EXPECT_TRUE(same_bits(Collider(limb.mesh, copy).positions(), positions));
  }
}

#ifdef MORULA_THREADS
TEST(PosedVertices, several_threads_read_the_same_positions_at_once) {
  Random random(11);
  PosedBody& posed = posed_limb();
  constexpr std::size_t thread_count = 4;
  for (int frame = 0; frame < 30; ++frame) {
    posed.pose(random_pose(random, 24, 0.3));
    std::vector<Ray> rays;
    std::vector<std::optional<RayPoint>> expected;
    for (int i = 0; i < 20; ++i) {
      rays.push_back(random_ray(random));
      expected.push_back(first_hit(posed.given, rays.back()).first);
    }
    std::vector<std::size_t> wrong(thread_count);
    std::vector<std::thread> threads;
    for (std::size_t k = 0; k < thread_count; ++k)
      threads.emplace_back([&, k] {
        if (k == 3 || (k == 2 && frame % 2 == 0)) wrong[k] += !same_bits(posed.collider.positions(), posed.positions);
        for (std::size_t i = 0; i < rays.size(); ++i)
          wrong[k] +=
              !same(first_hit(posed.collider, rays[(i + k) % rays.size()]).first, expected[(i + k) % rays.size()]);
        for (std::uint32_t v = 0; v < posed.positions.size(); ++v)
          wrong[k] += posed.collider.vertex(v) != posed.positions[v];
        const Body copy = posed.body;  // copies read a body, too
        wrong[k] += !same_bits(Collider(posed.mesh, copy).positions(), posed.positions);
      });
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(std::accumulate(wrong.begin(), wrong.end(), std::size_t{0}), 0u) << frame;
  }
}
#endif

}  // namespace
}  // namespace morula
