// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Distances against brute force over all pairs of facets, and against shapes whose distance is known.
#include <gtest/gtest.h>

#include <limits>
#include <morula/collide/distance.hpp>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "placed_bodies.hpp"
#include "stale_pose.hpp"

namespace morula {
namespace {

using test::PlacedBody;

double tolerance_of(const Collider& a, const Collider& b) {
  return 1e-14 * (test::largest_coordinate(a) + test::largest_coordinate(b));
}

void expect_witnesses(const Collider& a, const Collider& b, const DistanceBounds& found) {
  const double slack = tolerance_of(a, b);
  for (const auto& [body, p] : {std::pair{&a, &found.a}, std::pair{&b, &found.b}}) {
    ASSERT_LT(p->facet, body->mesh_facets().size());
    EXPECT_LE(distance(at_barycentric(body->triangle(p->facet), p->barycentric), p->point), slack);
    double sum = 0;
    for (const double w : p->barycentric) {
      EXPECT_GE(w, -1e-15);
      sum += w;
    }
    EXPECT_NEAR(sum, 1, 1e-14);
  }
  EXPECT_LE(distance(found.a.point, found.b.point), found.upper + slack);
}

// Every pair of bodies, deformed and placed at random: apart, near and through each other, here and far away.
template <class F>
void for_random_pairs(int rounds, const F& f) {
  Random random(5);
  for (int round = 0; round < rounds; ++round) {
    auto& bodies = test::placed_bodies();
    PlacedBody& a = *bodies[static_cast<std::size_t>(round) % bodies.size()];
    PlacedBody& b = *bodies[(static_cast<std::size_t>(round) / 2 + 1) % bodies.size()];
    if (&a == &b) continue;
    a.deform(test::rippled(a.mesh.positions, 0.2, static_cast<std::uint64_t>(round)));
    b.deform(test::rippled(b.mesh.positions, 0.15, static_cast<std::uint64_t>(round) + 99));
    const Vec3 about = round % 4 == 3 ? Vec3{1e6, -3e6, 2e6} : Vec3{};
    a.collider.set_transform(test::random_transform(random, 1.0, about));
    b.collider.set_transform(test::random_transform(random, round % 3 == 0 ? 8.0 : 2.0, about));
    f(a.collider, b.collider, round);
  }
}

TEST(Distance, equals_brute_force_over_random_poses) {
  int crossing = 0, apart = 0;
  DistanceQuery query;
  for_random_pairs(60, [&](const Collider& a, const Collider& b, int round) {
    const double expected = test::slow_distance(a, b), slack = tolerance_of(a, b);
    const DistanceBounds found = query.run(a, b);
    ASSERT_TRUE(found.status && found.complete && found.certified) << round;
    EXPECT_LE(found.lower, expected + slack) << round;
    EXPECT_GE(found.upper, expected - slack) << round;
    EXPECT_LE(found.upper - found.lower, 4 * slack) << round << " " << found.lower << " " << found.upper;
    expect_witnesses(a, b, found);
    if (expected == 0) {
      EXPECT_EQ(found.upper, 0) << round;
      EXPECT_TRUE(found.crossing) << round;
    }
    ++(expected == 0 ? crossing : apart);
  });
  EXPECT_GT(crossing, 5);
  EXPECT_GT(apart, 20);
}

TEST(Distance, bounds_hold_at_every_budget_and_more_only_tightens) {
  for_random_pairs(12, [&](const Collider& a, const Collider& b, int round) {
    const double expected = test::slow_distance(a, b), slack = tolerance_of(a, b);
    DistanceBounds last;
    last.lower = 0, last.upper = std::numeric_limits<double>::infinity();
    for (std::size_t budget = 0; budget < 4000; budget += 1 + budget / 7) {
      const DistanceBounds found = distance(a, b, {.budget = budget});
      EXPECT_LE(found.lower, expected + slack) << round << " at " << budget;
      EXPECT_GE(found.upper, expected - slack) << round << " at " << budget;
      EXPECT_GE(found.lower, last.lower) << round << " at " << budget;
      EXPECT_LE(found.upper, last.upper) << round << " at " << budget;
      // At most one expansion of a node is begun before it ends, and one walk over the facets of a leaf.
      EXPECT_LE(found.sphere_tests + found.facet_tests, budget + 100) << round;
      expect_witnesses(a, b, found);
      last = found;
    }
  });
}

TEST(Distance, stops_at_the_tolerance_and_at_the_thresholds) {
  std::size_t full = 0, less = 0;
  for_random_pairs(20, [&](const Collider& a, const Collider& b, int round) {
    const double expected = test::slow_distance(a, b), slack = tolerance_of(a, b);
    const DistanceBounds exact = distance(a, b), rough = distance(a, b, {.tolerance = 0.3});
    EXPECT_TRUE(rough.complete);
    EXPECT_LE(rough.upper - rough.lower, 0.3) << round;
    EXPECT_LE(rough.lower, expected + slack);
    EXPECT_GE(rough.upper, expected - slack);
    full += exact.sphere_tests, less += rough.sphere_tests;
    if (expected > 0.1) {
      const DistanceBounds far = distance(a, b, {.stop_above = 0.5 * expected});
      EXPECT_TRUE(far.farther && far.complete) << round;
      EXPECT_GT(far.lower, 0.5 * expected);
      EXPECT_LE(far.lower, expected + slack);
      EXPECT_LE(far.sphere_tests, exact.sphere_tests);
      const DistanceBounds near = distance(a, b, {.stop_below = 2 * expected});
      EXPECT_LE(near.upper, 2 * expected) << round;
      EXPECT_LE(near.lower, expected + slack) << round;
      EXPECT_FALSE(near.farther);
    }
    const DistanceBounds within = distance(a, b, {.stop_above = expected + 1});
    EXPECT_FALSE(within.farther);
    EXPECT_EQ(within.upper, exact.upper);
    const DistanceBounds spheres = distance(a, b, {.to_facets = false});
    EXPECT_TRUE(spheres.complete);
    EXPECT_LE(spheres.lower, expected + slack);
    EXPECT_GE(spheres.upper, expected - slack);
  });
  EXPECT_LT(less, full);
}

TEST(Distance, of_exact_shapes_is_known) {
  PlacedBody a(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 3)), b(test::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 2));
  b.collider.set_transform({.translation = {4, 0, 0}});
  EXPECT_NEAR(distance(a.collider, b.collider).upper, 2.5, 4e-14) << "side to side";
  b.collider.set_transform({.translation = {4, 3.5, 0}});
  EXPECT_NEAR(distance(a.collider, b.collider).upper, std::hypot(2.5, 2.0), 4e-14) << "edge to edge";
  b.collider.set_transform({.translation = {4, 3.5, -7}});
  EXPECT_NEAR(distance(a.collider, b.collider).upper, std::sqrt(2.5 * 2.5 + 2 * 2 + 5.5 * 5.5), 4e-14) << "corners";
  b.collider.set_transform({.translation = {0.1, 0.2, 0}});
  EXPECT_NEAR(distance(a.collider, b.collider).upper, 0.3, 4e-14) << "inside: as far as the wall";

  // Polyhedra inscribed in spheres lie within their sagitta of them.
  PlacedBody c(test::icosphere(3, 1.0)), d(test::icosphere(3, 0.5));
  const Vec3 offset{1.1, -1.3, 0.7};
  d.collider.set_transform({.translation = offset});
  const double expected = length(offset) - 1.5, found = distance(c.collider, d.collider).upper;
  EXPECT_GE(found, expected - 4e-14);
  EXPECT_LE(found, expected + 0.02);
}

TEST(Distance, of_touching_bodies_is_zero_and_of_nearly_touching_ones_is_not) {
  PlacedBody a(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2)), b(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 3));
  b.collider.set_transform({.translation = {2, 0.25, 0.5}});
  const DistanceBounds touching = distance(a.collider, b.collider);
  EXPECT_EQ(touching.lower, 0) << "sides that lie in one plane";
  EXPECT_EQ(touching.upper, 0);
  EXPECT_TRUE(touching.crossing);
  b.collider.set_transform({.translation = {2 + 1e-9, 0.25, 0.5}});
  const DistanceBounds nearly = distance(a.collider, b.collider);
  EXPECT_GT(nearly.lower, 0.999e-9);
  EXPECT_LT(nearly.upper, 1.001e-9);
  b.collider.set_transform({.translation = {2 - 1e-9, 0.25, 0.5}});
  const DistanceBounds through = distance(a.collider, b.collider);
  EXPECT_TRUE(through.crossing);
  EXPECT_EQ(through.upper, 0);
  // A corner of one on a side of the other, both exact in double.
  PlacedBody tip({{{1, 0, 0}, {2, 0.5, 0}, {2, -0.5, 0.25}}, {{0, 1, 2}}}, 1);
  const DistanceBounds on = distance(a.collider, tip.collider);
  EXPECT_TRUE(on.crossing);
  EXPECT_EQ(on.upper, 0);
}

TEST(Distance, a_body_laid_on_itself_crosses_at_every_budget) {
  for (const Mesh& mesh : {test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2), test::icosphere(2)}) {
    PlacedBody a(mesh), b(mesh);
    for (const Budget& budget : {Budget(0), Budget(1), Budget(50), Budget()}) {
      const DistanceBounds same = distance(a.collider, b.collider, {.budget = budget});
      EXPECT_TRUE(same.crossing) << budget.tests();
      EXPECT_EQ(same.upper, 0) << budget.tests();
      EXPECT_EQ(same.lower, 0) << budget.tests();
    }
    DistanceQuery query;
    for (int again = 0; again < 3; ++again) EXPECT_TRUE(query.run(a.collider, b.collider).crossing);
  }
}

// In one plane, no corner on another: exact in double, and nothing pierces.
TEST(Distance, coplanar_facets_that_overlap_cross_and_those_beside_each_other_do_not) {
  PlacedBody a({{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}}, 1);
  PlacedBody inside({{{0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}}, {{0, 1, 2}}}, 1);
  PlacedBody across({{{-1, 1, 0}, {5, 1, 0}, {-1, 1.5, 0}}, {{0, 1, 2}}}, 1);
  PlacedBody segment({{{-1, 1, 0}, {5, 1, 0}, {5, 1, 0}}, {{0, 1, 2}}}, 1);
  for (PlacedBody* b : {&inside, &across, &segment}) {
    const DistanceBounds found = distance(a.collider, b->collider);
    EXPECT_TRUE(found.crossing);
    EXPECT_EQ(found.upper, 0);
    b->collider.set_transform({.translation = {0, 0, 0x1p-60}});
    EXPECT_FALSE(distance(a.collider, b->collider).crossing) << "a plane above";
    b->collider.set_transform({.translation = {10, 0, 0}});
    EXPECT_FALSE(distance(a.collider, b->collider).crossing) << "beside";
  }
}

TEST(Distance, warm_start_keeps_the_bits_of_upper_bounds_and_points) {
  DistanceQuery warm;
  auto& bodies = test::placed_bodies();
  PlacedBody &a = *bodies[0], &b = *bodies[1];
  a.collider.set_transform({});
  int apart = 0;
  for (int frame = 0; frame < 40; ++frame) {
    a.deform(test::rippled(a.mesh.positions, 0.01 * frame, 3));
    b.collider.set_transform(RigidTransform::from_axis({1, 2, 3}, 0.05 * frame, {0.2, 1.5 + 0.05 * frame, 0.3}));
    const DistanceBounds x = warm.run(a.collider, b.collider), y = distance(a.collider, b.collider);
    EXPECT_NEAR(x.lower, y.lower, 1e-14);
    EXPECT_EQ(x.upper, y.upper);
    if (x.crossing) continue;
    ++apart;
    EXPECT_EQ(x.a.facet, y.a.facet);
    EXPECT_EQ(x.b.facet, y.b.facet);
    EXPECT_EQ(x.a.point, y.a.point);
    EXPECT_EQ(x.b.point, y.b.point);
  }
  EXPECT_GT(apart, 15);
}

TEST(Distance, holds_for_bodies_without_neighbors_area_or_closure) {
  PlacedBody point({{{5, 0, 0}, {5, 0, 0}, {5, 0, 0}}, {{0, 1, 2}}}, 1);
  PlacedBody line({{{0, -1, 0}, {0, 1, 0}, {0, 3, 0}}, {{0, 1, 2}}}, 1);
  EXPECT_NEAR(distance(point.collider, line.collider).upper, 5, 4e-14);
  EXPECT_NEAR(distance(point.collider, line.collider).lower, 5, 4e-14);
}

TEST(Distance, refuses_what_it_cannot_answer) {
  PlacedBody a(test::icosphere(1)), b(test::icosphere(1));
  b.collider.set_transform({.translation = {5, 0, 0}});
  DistanceQuery query;
  using test::nan;
  using Code = Status::Code;
  EXPECT_EQ(query.run(a.collider, b.collider, {.tolerance = nan}).status.code, Code::bad_option);
  EXPECT_EQ(query.run(a.collider, b.collider, {.stop_above = -1}).status.code, Code::bad_option);
  EXPECT_EQ(query.run(a.collider, b.collider, {.stop_below = nan}).status.code, Code::bad_option);
  std::vector<Vec3> moved = b.mesh.positions;
  test::StalePose late(b.mesh, b.model.cover, b.body.sphere_state());
  const DistanceBounds stale = query.run(a.collider, late.collider);
  EXPECT_EQ(stale.status, (Status{Code::positions_not_current, 1}));
  EXPECT_EQ(stale.lower, 0);
  EXPECT_EQ(stale.upper, std::numeric_limits<double>::infinity());
  EXPECT_THROW(static_cast<void>(distance(a.collider, late.collider)), std::invalid_argument);
  late.collider.set_positions(moved);
  EXPECT_TRUE(query.run(a.collider, late.collider).status);
  std::vector<Vec3> bad = a.mesh.positions;
  bad[0].x = nan;
  ASSERT_FALSE(a.body.update(bad));
  EXPECT_EQ(query.run(a.collider, b.collider).status, (Status{Code::body_not_current, 0}));
  ASSERT_TRUE(a.body.update(moved));
  a.collider.set_transform({.translation = {1e300, 0, 0}});
  EXPECT_EQ(query.run(a.collider, b.collider).status, (Status{Code::transform_too_far, 0}));
  for (const Code code : {Code::body_not_current, Code::positions_not_current, Code::transform_too_far,
                          Code::bad_option, Code::bad_shape})
    EXPECT_FALSE(message({code, 1}).empty());
}

TEST(Distance, says_when_spheres_are_no_proof) {
  const Mesh mesh = test::icosphere(1);
  const CoveredTree model = build(mesh, {.method = Method::octree, .depth = 2});
  const Body loose(mesh, model, {.rules = {Rule::approach1}}), tight(mesh, model);
  const Body raised(mesh, model, {.rules = {Rule::approach1}, .conservative = true});
  const Collider a(mesh, loose), b(mesh, tight), c(mesh, raised);
  EXPECT_FALSE(distance(a, b).certified);
  EXPECT_TRUE(distance(c, b).certified);
}

}  // namespace
}  // namespace morula
