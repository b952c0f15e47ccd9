// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <stdexcept>
#include <support/meshes.hpp>

namespace morula {
namespace {

using test::box_mesh;
using test::icosphere;

Sphere random_ball(const Box& box, double largest_radius, Random& random) {
  Vec3 c;
  for (int axis = 0; axis < 3; ++axis) c[axis] = random.uniform(box.lower[axis], box.upper[axis]);
  return {c, random.uniform(0.01, largest_radius)};
}

void expect_tolerance_kept(const BallProtrusion& e, const Sphere& ball, double tolerance) {
  EXPECT_GE(e.lower, 0);
  EXPECT_GE(e.upper, e.lower);
  EXPECT_LE(e.upper - e.lower, tolerance * ball.radius * (1 + 1e-12));
}

TEST(Protrusion, of_convex_objects_is_the_bound_from_the_center) {
  // Distance to a box, negative inside, by formula.
  const Vec3 half{1, 0.5, 0.25};
  const auto distance_to_box = [&](const Vec3& p) {
    const Vec3 q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
    return length(max(q, Vec3{0, 0, 0})) + std::min(0.0, std::max({q.x, q.y, q.z}));
  };
  const SignedDistance object(box_mesh(-half, half, 3));
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const Sphere ball = random_ball({Vec3{-2, -1, -1}, Vec3{2, 1, 1}}, 1.2, random);
    const double exact = std::max(0.0, ball.radius + distance_to_box(ball.center));
    const BallProtrusion e = protrusion(object, ball, 1e-3);
    expect_tolerance_kept(e, ball, 1e-3);
    EXPECT_LE(e.lower, exact + 1e-12);
    EXPECT_GE(e.upper, exact - 1e-12);
    EXPECT_NEAR(e.upper, exact, 1e-3 * ball.radius);
  }
}

TEST(Protrusion, lies_between_samples_of_the_ball_and_the_bound_from_the_center) {
  std::vector<test::NamedMesh> meshes;
  for (const char* name : {"nested_shells", "two_components", "cones_at_one_vertex", "inverted"})
    meshes.push_back(test::mesh_named(name));
  for (const char* name : {"torus", "limb", "two"})
    meshes.push_back({name, sample_body(name, 12), true, true, true, 0});
  Random random(2);
  const std::vector<Vec3> directions = fibonacci_directions(162);
  for (const test::NamedMesh& named : meshes) {
    const SignedDistance object(named.mesh);
    const Box box = bounding_box(named.mesh);
    for (int trial = 0; trial < 20; ++trial) {
      const Sphere ball = random_ball(box, 0.4 * box.diagonal(), random);
      const double tolerance = trial % 2 == 0 ? 1e-2 : 5e-2;
      const BallProtrusion e = protrusion(object, ball, tolerance);
      expect_tolerance_kept(e, ball, tolerance);
      double sampled = 0;
      for (const Vec3& u : directions) {
        sampled = std::max(sampled, object(ball.center + ball.radius * u));
        sampled = std::max(sampled, object(ball.center + ball.radius * std::cbrt(random.uniform()) * u));
      }
      EXPECT_GE(e.upper, sampled - 1e-12) << named.name;
      EXPECT_GE(e.lower, sampled - tolerance * ball.radius * (1 + 1e-12)) << named.name;
      EXPECT_LE(e.lower, object.protrusion_bound(ball) + 1e-12) << named.name;
      EXPECT_LE(e.upper, std::max(e.lower, object.protrusion_bound(ball)) + 1e-12) << named.name;
    }
  }
}

TEST(Protrusion, sees_a_cavity_that_the_balls_surface_does_not_touch) {
  const Mesh& shells =
      test::mesh_named("nested_shells").mesh;  // cube of side 4 with a cubic hole of side 2 in the middle
  const SignedDistance object(shells);
  for (const Sphere& ball : {Sphere{{2, 2, 2}, 1.8}, Sphere{{2.1, 1.95, 2.05}, 1.75}, Sphere{{2.1, 2.1, 2.1}, 1.71}}) {
    double on_the_surface = -1;
    for (const Vec3& u : fibonacci_directions(642))
      on_the_surface = std::max(on_the_surface, object(ball.center + ball.radius * u));
    ASSERT_LT(on_the_surface, 0.3);
    const BallProtrusion e = protrusion(object, ball, 1e-3);
    EXPECT_LE(e.lower, 1 + 1e-12);
    EXPECT_GE(e.upper, 1);
    expect_tolerance_kept(e, ball, 1e-3);
  }
}

TEST(Protrusion, finds_the_level_middle_of_a_slot) {
  // Every point of the middle plane is as far out as any other.
  const Mesh slot = test::joined(box_mesh({-4, -4, 0.3}, {4, 4, 4}), box_mesh({-4, -4, -4}, {4, 4, -0.3}));
  const SignedDistance object(slot);
  for (const Sphere& ball : {Sphere{{0, 0, 0}, 0.5}, Sphere{{0.1, 0.2, 0.2}, 0.7}, Sphere{{0.3, 0, -0.4}, 1.0}}) {
    const BallProtrusion e = protrusion(object, ball, 1e-2);
    EXPECT_LE(e.lower, 0.3 + 1e-12);
    EXPECT_GE(e.upper, 0.3 - 1e-12);
    expect_tolerance_kept(e, ball, 1e-2);
  }
}

TEST(Protrusion, of_a_ball_around_the_whole_object_is_exact) {
  const BallProtrusion e = protrusion(SignedDistance(box_mesh({-1, -1, -1}, {1, 1, 1})), {{0, 0, 0}, 5}, 1e-3);
  EXPECT_NEAR(e.upper, 4, 5e-3);
  // Off the middle the far side decides: the point of the ball farthest from the box lies straight above its top.
  const SignedDistance object(box_mesh({-1, -1, -1}, {1, 1, 1}));
  const BallProtrusion off = protrusion(object, {{0.25, 0, 0.5}, 5}, 1e-3);
  EXPECT_NEAR(off.upper, 4.5, 5e-3);
  EXPECT_GE(off.upper, 4.5 - 1e-12);
}

TEST(Protrusion, is_nothing_inside_and_the_distance_for_a_point) {
  const SignedDistance object(icosphere(3));
  const BallProtrusion inside = protrusion(object, {{0.1, 0.2, 0}, 0.5});
  EXPECT_EQ(inside.lower, 0);
  EXPECT_EQ(inside.upper, 0);
  const Vec3 p{1.5, 0.3, -0.4};
  const BallProtrusion point = protrusion(object, {p, 0});
  EXPECT_DOUBLE_EQ(point.lower, object(p));
  EXPECT_DOUBLE_EQ(point.upper, object(p));
}

TEST(Protrusion, bounds_at_different_tolerances_agree) {
  const SignedDistance object(sample_body("limb", 20));
  Random random(4);
  const Box box{{-2, -0.5, -0.5}, {2, 0.5, 0.5}};
  for (int trial = 0; trial < 20; ++trial) {
    const Sphere ball = random_ball(box, 0.7, random);
    const BallProtrusion fine = protrusion(object, ball, 1e-3);
    expect_tolerance_kept(fine, ball, 1e-3);
    for (const double tolerance : {1e-2, 1e-1, 1.0}) {
      const BallProtrusion coarse = protrusion(object, ball, tolerance);
      expect_tolerance_kept(coarse, ball, tolerance);
      EXPECT_LE(coarse.lower, fine.upper + 1e-12);
      EXPECT_GE(coarse.upper, fine.lower - 1e-12);
    }
  }
}

TEST(Protrusion, ends_for_tiny_balls_far_from_the_origin) {
  const Vec3 offset{1e6, 2e6, -1e6};
  const SignedDistance object(test::translated(sample_body("torus", 12), offset));
  for (const double r : {1e-3, 1e-7, 1e-12}) {
    const Sphere ball{offset + Vec3{1, 0.05, 0.35}, r};
    const BallProtrusion e = protrusion(object, ball, 1e-3);
    EXPECT_LE(e.upper - e.lower, 1e-3 * r + 1e-6);
  }
}

TEST(Protrusion, of_many_is_the_worst_and_the_mean_of_each) {
  const SignedDistance object(sample_body("blob", 24));
  Random random(6);
  std::vector<Sphere> spheres;
  for (int i = 0; i < 37; ++i) spheres.push_back(random_ball({{-1, -1, -1}, {1, 1, 1}}, 0.5, random));
  double worst = 0, sum = 0;
  for (const Sphere& s : spheres) {
    const double upper = protrusion(object, s, 1e-2).upper;
    worst = std::max(worst, upper);
    sum += upper;
  }
  Workers three(3);
  for (Workers* workers : {&serial_workers(), &three}) {
    const Protrusion many = protrusion(object, spheres, 1e-2, *workers);
    EXPECT_EQ(many.worst, worst);
    EXPECT_EQ(many.mean, sum / 37);
  }
  const Protrusion none = protrusion(object, std::span<const Sphere>{}, 1e-2);
  EXPECT_EQ(none.worst, 0);
  EXPECT_EQ(none.mean, 0);
}

TEST(Protrusion, refuses_bad_input) {
  const SignedDistance object(icosphere(1));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double bad : {0.0, -1.0, nan})
    EXPECT_THROW(protrusion(object, Sphere{{0, 0, 0}, 1}, bad), std::invalid_argument);
  EXPECT_THROW(protrusion(object, Sphere{{0, 0, 0}, -1}), std::invalid_argument);
  EXPECT_THROW(protrusion(object, std::vector<Sphere>{{{0, nan, 0}, 1}}), std::invalid_argument);
}

}  // namespace
}  // namespace morula
