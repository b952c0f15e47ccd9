// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Half spaces, spheres and capsules against bodies: brute force over all facets, and exact shapes.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/collide/primitives.hpp>
#include <set>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "placed_bodies.hpp"
#include "stale_pose.hpp"

namespace morula {
namespace {

using test::PlacedBody;

using test::infinity;
using test::nan;

double slow_signed_distance(const HalfSpace& h, const Triangle& t) {
  const double size = length(h.normal);
  return std::min({dot(h.normal, t[0]), dot(h.normal, t[1]), dot(h.normal, t[2])}) / size - h.offset / size;
}
double slow_signed_distance(const Sphere& s, const Triangle& t) {
  return std::sqrt(closest_point(t, s.center).squared_distance) - s.radius;
}
double slow_signed_distance(const Capsule& c, const Triangle& t) {
  return test::slow_segment_distance(c.p, c.q, t) - c.radius;
}
double signed_distance_of(const HalfSpace& h, const Vec3& x) {
  return (dot(h.normal, x) - h.offset) / length(h.normal);
}
double signed_distance_of(const Sphere& s, const Vec3& x) {
  return distance(s.center, x) - s.radius;
}
double signed_distance_of(const Capsule& c, const Vec3& x) {
  const Vec3 d = c.q - c.p;
  const double square = dot(d, d), s = square > 0 ? std::clamp(dot(x - c.p, d) / square, 0.0, 1.0) : 0.0;
  return distance(c.p + d * s, x) - c.radius;
}

// The signed distance on the axis, where there is no direction out.
double axis_distance(const HalfSpace&) {
  return -infinity;
}
double axis_distance(const Sphere& s) {
  return -s.radius;
}
double axis_distance(const Capsule& c) {
  return -c.radius;
}

template <class Shape>
void expect_equals_brute_force(PlacedBody& body, const Shape& shape, double margin, const std::string& what) {
  const double slack = 2e-14 * (test::largest_coordinate(body.collider) + 1);
  std::vector<double> distances;
  for (std::uint32_t f = 0; f < body.mesh.facet_count(); ++f)
    distances.push_back(slow_signed_distance(shape, body.collider.triangle(f)));
  const double expected = *std::min_element(distances.begin(), distances.end());

  const Touch nearest = touch(body.collider, shape, {.margin = margin, .nearest = true});
  ASSERT_TRUE(nearest.deepest && nearest.certified) << what;
  EXPECT_NEAR(-nearest.deepest->depth, expected, slack) << what;
  EXPECT_LE(nearest.lower, expected + slack) << what;
  EXPECT_GE(nearest.lower, expected - 3 * slack) << what;
  const SurfacePoint& p = nearest.deepest->point;
  EXPECT_NEAR(distances[p.facet], expected, slack);
  EXPECT_LE(distance(at_barycentric(body.collider.triangle(p.facet), p.barycentric), p.point), slack) << what;
  EXPECT_NEAR(signed_distance_of(shape, p.point), expected, slack) << what;
  EXPECT_NEAR(length(nearest.deepest->normal), 1, 1e-14) << what;
  // The normal leads out of the shape: a small step along it lengthens the distance by as much.
  // But on the axis of a capsule.
  if (signed_distance_of(shape, p.point) > axis_distance(shape) + 1e-6) {
    EXPECT_NEAR(signed_distance_of(shape, p.point + nearest.deepest->normal * 1e-3), expected + 1e-3, 1e-9 + slack)
        << what;
  }

  const Touch plain = touch(body.collider, shape, {.margin = margin});
  const Touch any = touch(body.collider, shape, {.margin = margin, .stop_at_first = true});
  if (expected < margin - slack) {
    EXPECT_TRUE(plain.touches && any.touches && nearest.touches) << what;
    EXPECT_FALSE(plain.proven_clear || any.proven_clear || nearest.proven_clear) << what;
    EXPECT_EQ(plain.deepest->point.facet, p.facet) << what;
    EXPECT_EQ(plain.deepest->depth, nearest.deepest->depth) << what;
    EXPECT_LE(any.facet_tests, plain.facet_tests);
    EXPECT_LE(any.lower, expected + slack) << what;
  } else if (expected > margin + slack) {
    EXPECT_TRUE(plain.proven_clear && any.proven_clear && nearest.proven_clear) << what;
    EXPECT_FALSE(plain.touches || any.touches || plain.deepest) << what;
    EXPECT_GT(plain.lower, margin);
    EXPECT_LE(plain.lower, expected + slack) << what;
  }

  const Touch listed = touch(body.collider, shape, {.margin = margin, .collect_all = true});
  std::set<std::uint32_t> facets;
  std::uint32_t last = 0;
  for (const TouchingFacet& touching : listed.facets) {
    if (!facets.empty()) {
      EXPECT_GT(touching.point.facet, last);
    }
    facets.insert(last = touching.point.facet);
    EXPECT_NEAR(-touching.depth, distances[last], slack);
  }
  for (std::uint32_t f = 0; f < distances.size(); ++f)
    if (std::abs(distances[f] - margin) > slack) {
      EXPECT_EQ(facets.contains(f), distances[f] < margin) << what << " facet " << f;
    }
  std::set<std::uint32_t> owned;
  for (const std::uint32_t leaf : listed.leaves) {
    EXPECT_TRUE(body.body.rest_tree().is_leaf(leaf));
    const auto of_leaf = body.collider.facets(leaf);
    owned.insert(of_leaf.begin(), of_leaf.end());
  }
  EXPECT_TRUE(std::includes(owned.begin(), owned.end(), facets.begin(), facets.end())) << what;
}

TEST(Primitives, equal_brute_force_over_random_poses) {
  Random random(11);
  for (int round = 0; round < 120; ++round) {
    auto& bodies = test::placed_bodies();
    PlacedBody& body = *bodies[static_cast<std::size_t>(round) % bodies.size()];
    body.deform(test::rippled(body.mesh.positions, 0.2, static_cast<std::uint64_t>(round)));
    const Vec3 about = round % 4 == 3 ? Vec3{-4e5, 1e6, 7e5} : Vec3{};
    body.collider.set_transform(test::random_transform(random, 0.5, about));
    const std::string what = body.name + " " + std::to_string(round);
    const double margin = round % 3 == 0 ? 0.0 : random.uniform(-0.2, 0.3);
    const Vec3 center = about + test::random_point(random, 2.5), other = about + test::random_point(random, 2.5);
    const double radius = random.uniform(0, 1.0);
    const Vec3 normal = test::random_point(random, 3.0);
    expect_equals_brute_force(body, HalfSpace{normal, dot(normal, center)}, margin, what + " plane");
    expect_equals_brute_force(body, Sphere{center, radius}, margin, what + " sphere");
    expect_equals_brute_force(body, Capsule{center, other, radius}, margin, what + " capsule");
  }
}

TEST(Primitives, answers_of_exact_shapes_are_known) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2));
  box.collider.set_transform({.translation = {0, 0, 3}});
  const Touch floor = touch(box.collider, HalfSpace{{0, 0, 2}, 5});
  EXPECT_EQ(floor.deepest->depth, 0.5) << "the lowest corners are at 2, the floor at 2.5";
  EXPECT_EQ(floor.deepest->normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(floor.deepest->point.point.z, 2);
  const Touch ball = touch(box.collider, Sphere{{0.3, 0.2, 1.5}, 0.75});
  EXPECT_NEAR(ball.deepest->depth, 0.25, 1e-15);
  EXPECT_LE(distance(ball.deepest->point.point, Vec3{0.3, 0.2, 2}), 1e-15);
  EXPECT_LE(distance(ball.deepest->normal, Vec3{0, 0, 1}), 1e-15);
  const Touch through = touch(box.collider, Capsule{{0.3, 0.2, 0}, {0.3, 0.2, 9}, 0.125});
  EXPECT_EQ(through.deepest->depth, 0.125) << "the axis meets the surface";
  EXPECT_NEAR(length(through.deepest->normal), 1, 1e-15);
}

TEST(Primitives, a_half_space_has_the_same_answer_for_normals_of_any_length) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2));
  const HalfSpace plain{{1, 2, -2}, -2.5};
  const Touch expected = touch(box.collider, plain, {.collect_all = true});
  ASSERT_TRUE(expected.deepest);
  for (const int exponent : {-1020, -600, -200, -199, -1, 0, 1, 199, 200, 600, 1020}) {
    HalfSpace scaled = plain;
    for (double* number : {&scaled.normal.x, &scaled.normal.y, &scaled.normal.z, &scaled.offset})
      *number = std::ldexp(*number, exponent);
    const Touch found = touch(box.collider, scaled, {.collect_all = true});
    ASSERT_TRUE(found.deepest) << exponent;
    EXPECT_EQ(found.deepest->depth, expected.deepest->depth) << exponent;
    EXPECT_EQ(found.deepest->normal, expected.deepest->normal) << exponent;
    EXPECT_EQ(found.lower, expected.lower) << exponent;
    EXPECT_EQ(found.facets.size(), expected.facets.size()) << exponent;
  }
  // The distance of the plane has a limit, the length of its normal has none.
  EXPECT_EQ(TouchQuery().run(box.collider, HalfSpace{{0, 0, 0x1p-300}, -0x1p-99}).status.code, Status::Code::bad_shape);
  EXPECT_TRUE(TouchQuery().run(box.collider, HalfSpace{{0, 0, 0x1p-300}, -0x1p-101}).proven_clear);
}

TEST(Primitives, a_shape_that_just_touches_touches) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 2));
  EXPECT_TRUE(touch(box.collider, HalfSpace{{0, 0, 1}, -1}).touches);
  EXPECT_TRUE(touch(box.collider, Sphere{{0.1, 0.2, 1.5}, 0.5}).touches);
  EXPECT_TRUE(touch(box.collider, Sphere{{1, 1, 1}, 0}).touches) << "a point on a corner";
  EXPECT_TRUE(touch(box.collider, HalfSpace{{0, 0, 1}, -1 - 1e-12}).proven_clear);
  EXPECT_TRUE(touch(box.collider, Sphere{{0.1, 0.2, 1.5}, 0.5 - 1e-12}).proven_clear);
}

TEST(Primitives, a_sphere_inside_a_body_touches_no_surface) {
  PlacedBody ball(test::icosphere(3));
  const Touch inside = touch(ball.collider, Sphere{{0, 0, 0.1}, 0.3});
  EXPECT_TRUE(inside.proven_clear);
  EXPECT_FALSE(inside.touches);
}

TEST(Primitives, cost_less_than_looking_at_everything) {
  PlacedBody ball(test::icosphere(4));
  const Touch near = touch(ball.collider, Sphere{{0, 0, 1.05}, 0.1});
  EXPECT_TRUE(near.touches);
  EXPECT_LT(near.facet_tests, ball.mesh.facet_count() / 10);
  const Touch far = touch(ball.collider, Sphere{{0, 0, 5}, 0.1});
  EXPECT_EQ(far.sphere_tests, 1u);
  EXPECT_EQ(far.facet_tests, 0u);
}

TEST(Primitives, refuse_what_is_no_shape) {
  PlacedBody ball(test::icosphere(1));
  using Code = Status::Code;
  TouchQuery query;
  test::StalePose late(ball.mesh, ball.model.cover, ball.body.sphere_state());
  const Collider* asked = &ball.collider;
  const auto fault = [&](const auto& shape, const TouchOptions& options = {}) {
    const Touch& result = query.run(*asked, shape, options);
    EXPECT_FALSE(result.touches || result.proven_clear || result.deepest);
    return result.status.code;
  };
  EXPECT_EQ(fault(Sphere{{0, 0, 0}, -1}), Code::bad_shape);
  EXPECT_EQ(fault(Sphere{{0, nan, 0}, 1}), Code::bad_shape);
  EXPECT_EQ(fault(Sphere{{0, 0, 0}, infinity}), Code::bad_shape);
  EXPECT_EQ(fault(HalfSpace{{0, 0, 0}, 1}), Code::bad_shape);
  EXPECT_EQ(fault(HalfSpace{{0, 0, 1}, nan}), Code::bad_shape);
  EXPECT_EQ(fault(Capsule{{0, 0, 0}, {infinity, 0, 0}, 1}), Code::bad_shape);
  EXPECT_EQ(fault(Capsule{{0, 0, 0}, {1, 0, 0}, nan}), Code::bad_shape);
  EXPECT_EQ(fault(Sphere{{0, 0, 0}, 1}, {.margin = nan}), Code::bad_option);
  asked = &late.collider;
  EXPECT_EQ(fault(Sphere{{0, 0, 0}, 1}), Code::positions_not_current);
  EXPECT_THROW(static_cast<void>(touch(late.collider, Sphere{{0, 0, 0}, 1})), std::invalid_argument);
}

}  // namespace
}  // namespace morula
