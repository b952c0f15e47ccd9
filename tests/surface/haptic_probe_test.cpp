// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The haptic probe on bodies at rest against all facets by brute force, and against shapes whose constrained nearest
// points are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <support/allocations.hpp>
#include <support/error_text.hpp>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "haptic_steps.hpp"

namespace morula {
namespace {

using test::expect_clear_path;
using test::PlacedBody;
using test::settle;

TEST(HapticProbe, never_passes_through_a_facet_however_far_the_device_jumps) {
  Random random(5);
  int touched = 0, settled = 0, steps = 0;
  for (const auto& held : test::placed_bodies()) {
    PlacedBody& body = *held;
    body.deform(body.mesh.positions);
    body.collider.set_transform({});
    const double size = body.collider.sphere_state().sphere(0).radius;
    const Vec3 middle = body.collider.sphere_state().sphere(0).center;
    for (const double share : {0.0, 0.01, 0.1}) {
      const double radius = share * size, skin = 1e-5 * size;
      HapticProbe probe({.radius = radius, .skin = skin});
      Vec3 device = middle + Vec3{2 * size, 0, 0};
      for (int k = 0; k < 25; ++k) {
        const bool jumps = k % 3 == 0;
        device =
            jumps ? middle + test::random_point(random, 0.6 * size) : device + test::random_point(random, 0.03 * size);
        const HapticStep step = probe.step(body.collider, device);
        ASSERT_TRUE(step.status) << message(step.status);
        EXPECT_TRUE(step.certified);
        EXPECT_FALSE(step.jammed);
        ASSERT_NO_FATAL_FAILURE(
            expect_clear_path(probe, body, radius, skin, body.name + ", step " + std::to_string(k)));
        touched += step.touches, settled += step.settled, ++steps;
      }
    }
  }
  EXPECT_GT(touched, steps / 4);
  EXPECT_GT(settled, steps / 2);
}

TEST(HapticProbe, stays_outside_of_a_closed_body_by_exact_windings) {
  Random random(6);
  for (const auto& held : test::placed_bodies()) {
    PlacedBody& body = *held;
    if (body.name != "limb" && body.name != "torus" && body.name != "box") continue;
    const double size = body.collider.sphere_state().sphere(0).radius;
    HapticProbe probe;
    Vec3 device{3 * size, 3 * size, 3 * size};
    ASSERT_TRUE(probe.step(body.collider, device).status);
    for (int k = 0; k < 200; ++k) {
      if (k % 10 == 0) device = test::random_point(random, size);
      device += test::random_point(random, 0.05 * size);
      const HapticStep step = probe.step(body.collider, device);
      ASSERT_TRUE(step.status);
      ASSERT_NEAR(test::slow_winding(body.collider, step.proxy), 0, 1e-3) << body.name << ", step " << k;
    }
  }
}

TEST(HapticProbe, is_the_nearest_point_for_one_two_and_three_planes) {
  // From inside of a box: a ball's center stays in a smaller box, and the nearest point of that is known.
  PlacedBody body(test::box_mesh({-1, -2, -3}, {1, 2, 3}, 4));
  const double radius = 0.2, skin = 1e-6, k = 300;
  HapticProbe probe({.radius = radius, .skin = skin, .stiffness = k});
  ASSERT_TRUE(probe.step(body.collider, {}).status);
  Random random(7);
  std::array<int, 4> counts{};
  for (int round = 0; round < 300; ++round) {
    const Vec3 device{random.uniform(-2, 2), random.uniform(-4, 4), random.uniform(-6, 6)};
    const HapticStep step = settle(probe, body.collider, device);
    ASSERT_TRUE(step.status && step.settled)
        << round << ": device " << device.x << " " << device.y << " " << device.z << ", proxy " << step.proxy.x << " "
        << step.proxy.y << " " << step.proxy.z;
    const double r = radius + skin;
    const Vec3 expected{std::clamp(device.x, r - 1, 1 - r), std::clamp(device.y, r - 2, 2 - r),
                        std::clamp(device.z, r - 3, 3 - r)};
    EXPECT_LT(distance(step.proxy, expected), skin) << round;
    EXPECT_LT(distance(step.force, k * (expected - device)), k * skin) << round;
    const int planes = (device.x != expected.x) + (device.y != expected.y) + (device.z != expected.z);
    ++counts[static_cast<std::size_t>(planes)];
    EXPECT_EQ(step.touches, planes > 0) << round;
  }
  for (const int count : counts) EXPECT_GT(count, 10);
}

TEST(HapticProbe, slides_along_a_groove_and_over_a_ridge) {
  // A roof along y and its mirror image: planes of 45 degrees at z = ∓|x|.
  const auto roof = [](double sign) {
    Mesh plate = test::grid_plate(8, 2, 4);
    for (Vec3& p : plate.positions) p = {p.x - 1, p.y - 2, sign * std::abs(p.x - 1)};
    return plate;
  };
  const double r = 0.05, skin = 1e-6, distance_kept = r + skin;
  PlacedBody groove(roof(1));
  HapticProbe in_groove({.radius = r, .skin = skin});
  ASSERT_TRUE(in_groove.step(groove.collider, {0, -1, 1}).status);
  for (double y = -1; y <= 1; y += 0.05) {
    const HapticStep step = settle(in_groove, groove.collider, {0.01 * std::sin(9 * y), y, -0.2});
    EXPECT_TRUE(step.settled);
    EXPECT_LT(distance(step.proxy, {0, y, std::sqrt(2.0) * distance_kept}), 4 * skin) << y;
  }
  // Over the ridge, the ball rolls around the edge: its center is at the distance kept from the edge, or above a plane.
  PlacedBody ridge(roof(-1));
  HapticProbe over({.radius = r, .skin = skin});
  ASSERT_TRUE(over.step(ridge.collider, {-0.5, 0, 1}).status);
  for (double x = -0.5; x <= 0.5; x += 0.01) {
    const Vec3 device{x, 0, -std::abs(x) - 0.02};
    const HapticStep step = settle(over, ridge.collider, device);
    EXPECT_TRUE(step.settled && step.touches);
    const double height = (step.proxy.z + std::abs(step.proxy.x)) / std::sqrt(2.0);  // above the nearer plane
    const bool at_edge = step.proxy.z > std::abs(step.proxy.x);
    const double kept = at_edge ? std::hypot(step.proxy.x, step.proxy.z) : height;
    EXPECT_NEAR(kept, distance_kept, 2 * skin) << x;
  }
}

TEST(HapticProbe, does_not_stick_at_the_edges_of_a_plane) {
  // The facets of the second plate share no vertices.
  PlacedBody plate(test::grid_plate(20)), soup(test::soup_of(test::grid_plate(20)));
  for (PlacedBody* body : {&plate, &soup})
    for (const double radius : {0.0, 0.03}) {
      HapticProbe probe({.radius = radius, .skin = 1e-6});
      ASSERT_TRUE(probe.step(body->collider, {0.1, 0.1, 0.2}).status);
      for (int k = 0; k <= 800; ++k) {
        const Vec3 device{0.1 + 0.001 * k, 0.1 + 0.0007 * k, -0.05};
        const HapticStep step = probe.step(body->collider, device);
        ASSERT_TRUE(step.status);
        EXPECT_TRUE(step.settled) << k;
        EXPECT_LT(distance(step.proxy, {device.x, device.y, radius + 1e-6}), 1e-6) << k;
      }
    }
}

TEST(HapticProbe, holds_on_a_plate_much_thinner_than_a_step_and_on_both_sides_of_an_open_one) {
  PlacedBody thin(test::box_mesh({-1, -1, -5e-4}, {1, 1, 5e-4}, 6)),
      open(test::translated(test::grid_plate(9), {-0.5, -0.5, 0}));
  for (PlacedBody* body : {&thin, &open})
    for (const double side : {1.0, -1.0}) {
      HapticProbe probe({.skin = 1e-6});
      for (int k = 0; k < 20; ++k) {
        const double height = k % 2 == 0 ? 0.4 : -0.4;
        const HapticStep step = settle(probe, body->collider, {0.01 * k, -0.013 * k, side * height});
        ASSERT_TRUE(step.settled);
        EXPECT_EQ(step.touches, k % 2 == 1);
        EXPECT_GT(side * step.proxy.z, 0) << k;
        EXPECT_GE(side * step.force.z, 0);
        if (k % 2 == 1) {
          EXPECT_GT(side * step.normal.z, 0.999);
        }
      }
    }
}

TEST(HapticProbe, follows_the_device_where_it_is_free_from_near_and_from_far) {
  PlacedBody body(test::icosphere(2));
  HapticProbe probe({.radius = 0.1});
  for (const Vec3& device : {Vec3{2, 0, 0}, Vec3{0, 0, 3}, Vec3{1e9, 0, 0}, Vec3{-1e30, 1e12, 0}, Vec3{0, 1.2, 0}}) {
    const HapticStep step = settle(probe, body.collider, device);
    ASSERT_TRUE(step.status && step.settled);
    EXPECT_LE(distance(step.proxy, device), 1e-15 * length(device));
    EXPECT_LE(length(step.force), 1e-15 * length(device));
    EXPECT_FALSE(step.touches);
  }
  // From far through the middle: it stops on the near side.
  for (const double far : {1e3, 1e9, 1e15}) {
    probe.reset();
    ASSERT_TRUE(probe.step(body.collider, {far, 1e-3, 2e-3}).status);
    const HapticStep step = settle(probe, body.collider, {-0.5, 0, 0});
    EXPECT_TRUE(step.touches) << far;
    EXPECT_GT(step.proxy.x, 0) << far;
    EXPECT_NEAR(length(step.proxy), 1.1, 0.05) << far;
  }
}

TEST(HapticProbe, keeps_its_radius_when_it_comes_from_far_away) {
  PlacedBody body(test::icosphere(2));
  for (const double far : {1e13, 1e14, 1e15, 3e15})
    for (const Vec3& from : {Vec3{1, 0, 0}, Vec3{0.3, -0.7, 0.2}, Vec3{-0.1, 0.2, 0.9}}) {
      HapticProbe probe({.radius = 0.1});
      ASSERT_TRUE(probe.step(body.collider, far * from).status);
      for (int k = 0; k < 4; ++k) {
        ASSERT_TRUE(probe.step(body.collider, {0.1, 0.1, 0}).status);
        for (const Vec3& at : probe.path().subspan(1)) ASSERT_GT(test::slow_clearance(body, at, at), 0.1) << far;
      }
    }
}

TEST(HapticProbe, turns_smoothly_over_facets_with_smooth_normals) {
  PlacedBody body(test::uv_sphere(24, 12));
  double largest[2];
  for (const bool smooth : {false, true}) {
    HapticProbe probe({.skin = 1e-6, .stiffness = 10, .smooth_normals = smooth});
    Vec3 last{};
    double& jump = largest[smooth ? 1 : 0];
    jump = 0;
    ASSERT_TRUE(probe.step(body.collider, {0, 2, 0.4}).status);
    for (int k = 0; k < 3000; ++k) {
      const double angle = 2 * test::pi * k / 3000;
      const Vec3 device{0.85 * std::sin(angle), 0.85 * std::cos(angle), 0.35};
      const HapticStep step = settle(probe, body.collider, device);
      ASSERT_TRUE(step.settled && step.touches) << k;
      const Vec3 direction = normalized(step.force);
      EXPECT_GT(dot(direction, normalized(step.proxy)), 0.9);
      if (k > 0) jump = std::max(jump, distance(direction, last));
      last = direction;
    }
  }
  // 24 facets around: their normals differ by 15 degrees.
  EXPECT_GT(largest[0], 0.2);
  EXPECT_LT(largest[1], 0.02);
}

TEST(HapticProbe, sticks_in_the_cone_of_friction_and_slips_beyond) {
  PlacedBody plate(test::grid_plate(10));
  const double depth = 0.04, friction = 0.5, skin = 1e-6;
  HapticProbe probe({.skin = skin, .stiffness = 100, .friction = friction});
  ASSERT_TRUE(probe.step(plate.collider, {0.2, 0.5, 0.1}).status);
  ASSERT_TRUE(settle(probe, plate.collider, {0.2, 0.5, -depth}).settled);
  for (double x = 0.2; x < 0.8; x += 0.004) {
    const HapticStep step = settle(probe, plate.collider, {x, 0.5, -depth});
    ASSERT_TRUE(step.settled);
    const double lag = friction * (depth + skin);
    EXPECT_NEAR(step.proxy.x, std::max(0.2, x - lag), 2 * skin) << x;
    EXPECT_LE(std::abs(step.force.x), friction * step.force.z * (1 + 1e-4)) << x;
  }
}

TEST(HapticProbe, starts_again_after_a_reset_and_away_from_a_surface_that_it_starts_on) {
  PlacedBody plate(test::grid_plate(10));
  HapticProbe probe({.radius = 0.05, .skin = 1e-6});
  EXPECT_TRUE(probe.path().empty());
  ASSERT_TRUE(probe.step(plate.collider, {0.5, 0.5, 0.3}).status);
  EXPECT_GT(settle(probe, plate.collider, {0.5, 0.5, -0.3}).proxy.z, 0);
  probe.reset();
  EXPECT_TRUE(probe.path().empty());
  EXPECT_EQ(probe.step(plate.collider, {0.5, 0.5, -0.3}).proxy, (Vec3{0.5, 0.5, -0.3}));
  EXPECT_NEAR(settle(probe, plate.collider, {0.5, 0.5, 0.3}).proxy.z, -0.05 - 1e-6, 1e-7);
  for (const double height : {0.0, 0.01, -0.01}) {
    probe.reset();
    const HapticStep step = settle(probe, plate.collider, {0.5, 0.5, height});
    EXPECT_NEAR(step.proxy.z, height < 0 ? -0.05 - 1e-6 : 0.05 + 1e-6, 1e-7) << height;
  }
}

TEST(HapticProbe, rejects_bad_input_by_name_and_keeps_the_proxy) {
  using Code = Status::Code;
  const auto error = [](const HapticOptions& options) { return test::error_text([&] { HapticProbe probe(options); }); };
  EXPECT_EQ(error({}), "");
  EXPECT_NE(error({.radius = -1}).find("HapticOptions::radius"), std::string::npos);
  EXPECT_NE(error({.radius = test::nan}).find("HapticOptions::radius"), std::string::npos);
  EXPECT_NE(error({.skin = 0.0}).find("HapticOptions::skin"), std::string::npos);
  EXPECT_NE(error({.stiffness = test::infinity}).find("HapticOptions::stiffness"), std::string::npos);
  EXPECT_NE(error({.friction = -0.1}).find("HapticOptions::friction"), std::string::npos);
  EXPECT_NE(error({.max_moves = 0}).find("HapticOptions::max_moves"), std::string::npos);

  PlacedBody body(test::icosphere(1)), other(test::icosphere(2));
  HapticProbe probe, expected;
  for (const Vec3& bad : {Vec3{test::nan, 0, 0}, Vec3{0, -test::infinity, 0}, Vec3{0, 0, 0x1p200}}) {
    EXPECT_EQ(probe.step(body.collider, bad).status.code, Code::bad_shape);
    ASSERT_TRUE(probe.step(body.collider, {2, 0, 0}).status);
  }
  EXPECT_EQ(probe.step(other.collider, {0.5, 0, 0}).status.code, Code::other_bodies);
  std::vector<Vec3> broken = body.mesh.positions;
  broken[3].x = test::nan;
  EXPECT_FALSE(body.body.update(broken));
  EXPECT_EQ(probe.step(body.collider, {0.5, 0, 0}).status.code, Code::body_not_current);
  body.deform(body.mesh.positions);
  ASSERT_TRUE(expected.step(body.collider, {2, 0, 0}).status);
  EXPECT_EQ(settle(probe, body.collider, {0.5, 0, 0}).proxy, settle(expected, body.collider, {0.5, 0, 0}).proxy);

  const Collider bare(body.body.sphere_state());
  EXPECT_EQ(probe.step(bare, {}).status.code, Code::no_surface);
  HapticProbe fine({.skin = 1e-12});
  EXPECT_EQ(fine.step(body.collider, {2, 0, 0}).status.code, Code::bad_option);
}

TEST(HapticProbe, allocates_nothing_once_warm) {
  PlacedBody body(sample_body("limb", 24));
  HapticProbe probe({.radius = 0.02, .smooth_normals = true});
  const std::vector<Vec3> moved = test::rippled(body.mesh.positions, 0.02, 3);
  const auto scene = [&] {
    for (int k = 0; k < 40; ++k) {
      if (k % 10 == 0 && !body.body.update(k % 20 == 0 ? moved : body.mesh.positions)) FAIL();
      const double angle = 0.16 * k;
      ASSERT_TRUE(probe.step(body.collider, {std::sin(angle), 0, k % 20 < 3 ? 2 : 0.2 * std::cos(angle)}).status);
    }
  };
  EXPECT_EQ(test::allocations_once_warm(scene), 0u);
}

}  // namespace
}  // namespace morula
