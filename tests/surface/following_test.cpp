// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surfaces that follow bodies find what brute force and updated surfaces find, and look only where spheres are near.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <morula/collide/crossings.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/obstacles.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <morula/update/body.hpp>
#include <support/aligned.hpp>
#include <support/allocations.hpp>
#include <support/transforms.hpp>

#include "surfaces.hpp"

namespace morula {
namespace {

using Code = Status::Code;

struct Follower {
  Mesh mesh;
  CoveredTree model;
  Body body;
  Collider collider;
  SurfaceTree surface, updated;
  std::vector<Vec3> at;
  std::vector<Vec3f> narrow;  // the same rounded, for bodies of floats
  std::vector<Vec3> world;

  Follower(const Mesh& given, const BuildOptions& build_options, const UpdateOptions& options = {})
      : mesh(given),
        model(build(mesh, build_options)),
        body(mesh, model, options),
        collider(mesh, body),
        surface(mesh),
        updated(mesh) {}

  // In double, or in float.
  void move(const std::vector<Vec3>& to, const RigidTransform& transform, bool is_float) {
    at = to;
    narrow.clear();
    for (Vec3& p : at) {
      narrow.push_back({static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)});
      if (is_float) p = Vec3(narrow.back());
    }
    ASSERT_TRUE(is_float ? body.update(PositionView(narrow)) : body.update(PositionView(at)));
    collider.set_transform(transform);
    world.clear();
    for (std::uint32_t v = 0; v < at.size(); ++v) world.push_back(collider.vertex(v));
    ASSERT_TRUE(updated.update(world));
    ASSERT_TRUE(surface.follow(collider));
    ASSERT_TRUE(surface.is_following());
    ASSERT_FALSE(surface.is_step());
  }
};

std::vector<Vec3> bent(const Mesh& mesh, double share, Random& random) {
  const Box box = bounding_box(mesh);
  const double size = std::max(max_norm(box.extent()), 1e-3);
  const Vec3 along{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) {
    const double t = dot(along, p - box.center()) / size;
    p += Vec3{t * t, std::sin(3 * t), -t} * (share * size) +
         Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)} * (0.02 * share * size);
  }
  return positions;
}

bool are_same(std::span<const ProximityPair> a, std::span<const ProximityPair> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ProximityPair& p, const ProximityPair& q) {
    return static_cast<const FeaturePair&>(p) == q && p.distance == q.distance && p.weights_a == q.weights_a &&
           p.weights_b == q.weights_b && p.point_a == q.point_a && p.point_b == q.point_b;
  });
}

struct Asked {
  std::size_t crossings = 0, near = 0, tests = 0, tests_updated = 0;
};

void expect_the_same(const Follower& a, const Follower& b, double distance, Asked& asked) {
  SurfaceCrossingQuery crossings, expected_crossings;
  const SurfaceQueryStatus status = crossings.run(a.surface, b.surface);
  ASSERT_TRUE(status && status.finished) << message(status);
  asked.tests += status.box_tests;
  asked.tests_updated += expected_crossings.run(a.updated, b.updated).box_tests;
  EXPECT_TRUE(std::equal(crossings.pairs().begin(), crossings.pairs().end(), expected_crossings.pairs().begin(),
                         expected_crossings.pairs().end()));
  // Nothing of trees in it.
  const std::vector<Crossing> all = brute_force::crossings(a.collider, b.collider);
  ASSERT_EQ(all.size(), crossings.pairs().size());
  for (std::size_t i = 0; i < all.size(); ++i)
    EXPECT_EQ((FeaturePair{PairKind::facet_facet, all[i].facet_a, all[i].facet_b}), crossings.pairs()[i]);
  asked.crossings += all.size();

  ProximityQuery near({.distance = distance}), expected({.distance = distance});
  ASSERT_TRUE(near.run(a.surface, b.surface).finished);
  ASSERT_TRUE(expected.run(a.updated, b.updated).finished);
  EXPECT_TRUE(are_same(near.pairs(), expected.pairs())) << near.pairs().size() << " of " << expected.pairs().size();
  asked.near += expected.pairs().size();
}

// A transform that brings some vertex of b upon some vertex of a, perhaps turned, perhaps off by a little.
RigidTransform touching(const Follower& a, const Follower& b, std::span<const Vec3> to, double off, Random& random) {
  RigidTransform t;
  if (random.uniform(0, 1) < 0.5)
    t = RigidTransform::from_quaternion(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1),
                                        random.uniform(-1, 1));
  const auto any = [&](std::size_t count) {
    return static_cast<std::size_t>(random.uniform(0, 1) * 0.999 * static_cast<double>(count));
  };
  const Facet &f = a.mesh.facets[any(a.mesh.facets.size())], &g = b.mesh.facets[any(b.mesh.facets.size())];
  t.translation = a.world[f[0]] - t.rotate(to[g[1]]) + Vec3{off, off, -off};
  return t;
}

TEST(Following, finds_what_brute_force_and_updated_surfaces_find) {
  Random random(5);
  const std::vector<test::NamedMesh>& bodies = test::aligned_bodies();
  Asked asked;
  // Every other one: scripts/properties asks many more such pairs.
  for (std::size_t i = 0; i < bodies.size(); i += 2) {
    const Mesh &mesh_a = bodies[i].mesh, &mesh_b = bodies[(i * 7 + 3) % bodies.size()].mesh;
    SCOPED_TRACE(bodies[i].name + " and " + bodies[(i * 7 + 3) % bodies.size()].name);
    const Method method = i % 16 == 4 ? Method::optimized : i % 4 == 0 ? Method::octree : Method::grid;
    const BuildOptions options{.method = method, .branching = 4, .depth = 2};
    Follower a(mesh_a, options), b(mesh_b, options);
    for (int frame = 0; frame < 4; ++frame) {
      SCOPED_TRACE(frame);
      const double far = frame == 3 ? 1e6 : 0;
      a.move(bent(mesh_a, 0.3 * frame, random),
             frame == 0 ? RigidTransform{} : RigidTransform::from_axis({1, 2, 3}, frame, {far, -far, 1}), frame == 2);
      const std::vector<Vec3> to = bent(mesh_b, 0.2 * frame, random);
      b.move(to, touching(a, b, to, frame == 1 ? 0 : 0.01, random), false);
      const double size = max_norm(bounding_box(mesh_a).extent());
      expect_the_same(a, b, (frame % 2 == 0 ? 0.02 : 0.5) * size, asked);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(asked.crossings, 1000u);
  EXPECT_GT(asked.near, 10000u);
}

TEST(Following, makes_boxes_only_where_spheres_are_near) {
  const Mesh limb = sample_body("limb", 48);
  Follower a(limb, {.quality = Quality::fast}), b(limb, {.quality = Quality::fast});
  const Box box = bounding_box(limb);
  Asked touching, apart;
  a.move(limb.positions, {}, false);
  b.move(limb.positions, {.translation = Vec3{0.01, 0.02, 0.8 * box.extent().z}}, false);
  expect_the_same(a, b, 0, touching);
  EXPECT_GT(touching.crossings, 0u);
  EXPECT_LT(touching.tests, touching.tests_updated);
  b.move(limb.positions, {.translation = Vec3{3 * box.extent().x, 0, 0}}, true);
  expect_the_same(a, b, 0, apart);
  EXPECT_EQ(apart.tests, 64u) << "one look at boxes of which none is made";
}

TEST(Following, answers_for_all_of_the_surface_where_spheres_say_nothing) {
  Random random(8);
  const Mesh limb = sample_body("limb", 24);
  // Approach 2 does not cover; of one surface alone, and of one with an updated one, spheres are not asked.
  UpdateOptions loose;
  loose.rules = {Rule::approach2};
  Follower a(limb, {.quality = Quality::fast}, loose), b(limb, {.quality = Quality::fast});
  const std::vector<Vec3> folded = bent(limb, 1.5, random);
  a.move(folded, {}, false);
  b.move(bent(limb, 0.3, random), touching(a, b, limb.positions, 0, random), false);
  Asked asked;
  expect_the_same(a, b, 0.1, asked);
  EXPECT_GT(asked.crossings, 0u);
  a.move(limb.positions, {}, false);
  b.move(limb.positions, {.translation = Vec3{0.01, 0.02, 0.8 * bounding_box(limb).extent().z}}, false);
  expect_the_same(a, b, 0, asked);
  EXPECT_EQ(asked.tests, asked.tests_updated);
  a.move(folded, {}, false);

  const auto pairs = [](const SurfaceTree& first, const SurfaceTree* second) {
    SurfaceCrossingQuery query;
    const SurfaceQueryStatus status = second != nullptr ? query.run(first, *second) : query.run(first);
    EXPECT_TRUE(status.finished);
    return std::vector<FeaturePair>(query.pairs().begin(), query.pairs().end());
  };
  EXPECT_EQ(pairs(a.surface, nullptr), pairs(a.updated, nullptr));
  EXPECT_GT(pairs(a.updated, nullptr).size(), 0u);
  EXPECT_EQ(pairs(b.surface, &a.updated), pairs(b.updated, &a.updated));
  EXPECT_EQ(pairs(a.updated, &b.surface), pairs(a.updated, &b.updated));
  EXPECT_EQ(b.surface.hash(), b.updated.hash());

  const auto impacts = [](const SurfaceTree& first, const SurfaceTree& second) {
    SweptQuery query({.distance = 0.01, .candidates_only = true});
    const SurfaceQueryStatus status = query.run(first, second);
    EXPECT_TRUE(status.finished);
    return query.pairs().size() + status.candidates;
  };
  EXPECT_EQ(impacts(a.surface, b.surface), impacts(a.updated, b.updated));
  ObstacleQuery obstacle, expected;
  const Obstacle floor(HalfSpace{{0, 0, 1}, b.world[0].z});
  ASSERT_TRUE(obstacle.run(b.surface, floor));
  ASSERT_TRUE(expected.run(b.updated, floor));
  ASSERT_GT(expected.contacts().size(), 0u);
  EXPECT_EQ(obstacle.contacts().size(), expected.contacts().size());
}

TEST(Following, is_the_same_for_any_number_of_workers_and_after_every_interruption) {
  Random random(9);
  const Mesh limb = sample_body("limb", 24);
  Follower a(limb, {.quality = Quality::fast}), b(limb, {.quality = Quality::fast});
  a.move(bent(limb, 0.3, random), {}, false);
  b.move(bent(limb, 0.2, random), touching(a, b, limb.positions, 0, random), false);
  ProximityQuery whole({.distance = 0.05}), parted({.distance = 0.05}), pieces({.distance = 0.05, .budget = 640});
  ASSERT_TRUE(whole.run(a.surface, b.surface).finished);
  ASSERT_GT(whole.pairs().size(), 100u);
  Workers three(3);
  ASSERT_TRUE(parted.run(a.surface, b.surface, three).finished);
  EXPECT_TRUE(are_same(whole.pairs(), parted.pairs()));
  SurfaceQueryStatus status = pieces.run(a.surface, b.surface);
  EXPECT_FALSE(status.finished);
  for (int calls = 0; status && !status.finished && calls < 100000; ++calls) status = pieces.resume();
  EXPECT_TRUE(are_same(whole.pairs(), pieces.pairs()));
  // Several queries may ask the same surfaces at the same time.
  std::vector<ProximityQuery> together;
  for (int i = 0; i < 6; ++i) together.emplace_back(ProximityOptions{.distance = 0.05});
  three.run(together.size(), [&](std::size_t i) { EXPECT_TRUE(together[i].run(a.surface, b.surface)); });
  for (const ProximityQuery& query : together) EXPECT_TRUE(are_same(whole.pairs(), query.pairs()));
}

TEST(Following, refuses_a_body_that_has_moved_and_stays_as_it_was_after_refusals) {
  const Mesh limb = sample_body("limb", 12), other = sample_body("limb", 16);
  Follower a(limb, {.quality = Quality::fast}), b(limb, {.quality = Quality::fast});
  Follower of_others(other, {.quality = Quality::fast});
  a.move(limb.positions, {}, false);
  b.move(limb.positions, {}, false);
  SurfaceCrossingQuery query({.budget = 64});
  ASSERT_FALSE(query.run(a.surface, b.surface).finished);
  ASSERT_TRUE(b.body.update(PositionView(b.at)));
  EXPECT_EQ(query.resume().code, Code::other_frame);
  EXPECT_EQ(query.run(a.surface, b.surface), (SurfaceQueryStatus{{Code::surface_not_current, 1}}));
  EXPECT_EQ(query.run(b.surface).code, Code::surface_not_current);
  EXPECT_THROW(static_cast<void>(b.surface.hash()), std::invalid_argument);
  EXPECT_EQ(ObstacleQuery().run(b.surface, Obstacle(HalfSpace{{0, 0, 1}, 0})).code, Code::surface_not_current);
  ASSERT_TRUE(b.surface.follow(b.collider));
  EXPECT_TRUE(query.run(a.surface, b.surface));

  const std::uint64_t before = a.surface.hash();
  EXPECT_EQ(a.surface.follow(of_others.collider).code, Code::wrong_vertex_count);
  Mesh turned = limb;
  std::swap(turned.facets[3][0], turned.facets[3][1]);
  const CoveredTree model = build(turned, {.quality = Quality::fast});
  const Body body(turned, model);
  EXPECT_THROW(static_cast<void>(a.surface.follow(Collider(turned, body))), std::invalid_argument);
  EXPECT_EQ(a.surface.follow(Collider(b.body.sphere_state())).code, Code::no_surface);
  EXPECT_EQ(a.surface.hash(), before);
  EXPECT_TRUE(a.surface.is_following());
  b.collider.set_transform({.translation = {0x1p150, 0, 0}});
  EXPECT_EQ(a.surface.follow(b.collider).code, Code::non_finite_position);
  EXPECT_EQ(a.surface.hash(), before);

  // A refusal leaves which blocks go with which leaf as it was, too: the other body's tree is another one.
  Follower coarse(limb, {.method = Method::octree, .depth = 1});
  coarse.move(limb.positions, {}, false);
  coarse.collider.set_transform({.translation = {0x1p150, 0, 0}});
  EXPECT_EQ(a.surface.follow(coarse.collider).code, Code::non_finite_position);
  b.collider.set_transform({.translation = Vec3{0.01, 0.02, 0.8 * bounding_box(limb).extent().z}});
  for (std::uint32_t v = 0; v < b.world.size(); ++v) b.world[v] = b.collider.vertex(v);
  ASSERT_TRUE(b.surface.follow(b.collider) && b.updated.update(b.world));
  Asked asked;
  expect_the_same(a, b, 0.01, asked);
  EXPECT_GT(asked.crossings, 0u);

  // Positions that the body refuses are no longer those of its spheres.
  a.at[0].x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(a.body.update(PositionView(a.at)));
  EXPECT_EQ(query.run(a.surface, b.surface).code, Code::surface_not_current);
  ASSERT_TRUE(a.surface.update(a.world));
  EXPECT_FALSE(a.surface.is_following());
  EXPECT_EQ(a.surface.hash(), a.updated.hash());
}

TEST(Following, allocates_nothing_once_it_is_warm) {
  Random random(10);
  const Mesh limb = sample_body("limb", 24);
  Follower a(limb, {.quality = Quality::fast}), b(limb, {.quality = Quality::fast});
  a.move(limb.positions, {}, false);
  const RigidTransform transform = touching(a, b, limb.positions, 0, random);
  b.move(limb.positions, transform, false);
  SurfaceCrossingQuery crossings;
  ProximityQuery near({.distance = 0.05});
  bool good = true;
  const auto ask = [&] {
    good = good && a.body.update(PositionView(a.at)) && b.body.update(PositionView(b.at)) &&
           a.surface.follow(a.collider) && b.surface.follow(b.collider) && crossings.run(a.surface, b.surface) &&
           near.run(a.surface, b.surface);
  };
  EXPECT_EQ(test::allocations_once_warm(ask), 0u);
  EXPECT_TRUE(good);
}

}  // namespace
}  // namespace morula
