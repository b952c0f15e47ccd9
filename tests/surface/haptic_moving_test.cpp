// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The haptic probe on bodies that move and deform, by windings and heights over all facets.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/haptic_probe.hpp>
#include <optional>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "haptic_steps.hpp"

namespace morula {
namespace {

using test::expect_clear_path;
using test::PlacedBody;
using test::settle;

TEST(HapticProbe, moves_rigidly_with_its_body) {
  PlacedBody body(sample_body("limb", 24));
  Random random(9);
  HapticProbe at_rest({.radius = 0.05}), moving({.radius = 0.05});
  for (int k = 0; k < 100; ++k) {
    const Vec3 device = test::random_point(random, 1.5);
    body.collider.set_transform({});
    const HapticStep expected = at_rest.step(body.collider, device);
    const RigidTransform transform = test::random_transform(random, 3);
    body.collider.set_transform(transform);
    const HapticStep found = moving.step(body.collider, transform(device));
    ASSERT_TRUE(expected.status && found.status);
    EXPECT_LT(distance(found.proxy, transform(expected.proxy)), 1e-9) << k;
    EXPECT_LT(distance(found.force, transform.rotate(expected.force)), 1e-9) << k;
    EXPECT_EQ(found.touches, expected.touches);
  }
}

TEST(HapticProbe, is_pushed_by_a_surface_that_moves_farther_than_its_skin_in_one_frame) {
  const Mesh mesh = test::translated(test::grid_plate(12), {-0.5, -0.5, 0});
  for (const double radius : {0.0, 0.02})
    for (const double side : {1.0, -1.0}) {
      PlacedBody body(mesh);
      HapticProbe probe({.radius = radius, .skin = 1e-6});
      ASSERT_TRUE(probe.step(body.collider, {0.03, 0.04, side * 0.2}).status);
      for (int frame = 0; frame < 60; ++frame) {
        // Up and down through the device, tilting and rippling.
        std::vector<Vec3> moved = mesh.positions;
        for (Vec3& p : moved)
          p.z = 0.4 * std::sin(0.7 * frame) + 0.3 * p.x * std::sin(0.45 * frame) + 0.02 * std::sin(20 * p.y + frame);
        body.deform(moved);
        const HapticStep step = settle(probe, body.collider, {0.03, 0.04, side * 0.1});
        ASSERT_TRUE(step.status);
        EXPECT_FALSE(step.jammed) << frame;
        // The height of the surface below the proxy, facet by facet.
        double height = test::nan;
        for (const Facet& f : mesh.facets) {
          const Triangle t{moved[f[0]], moved[f[1]], moved[f[2]]};
          const Vec3 n = area_vector(t);
          bool inside = true;
          for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 edge = t[(k + 1) % 3] - t[k], out = step.proxy - t[k];
            inside = inside && edge.x * out.y - edge.y * out.x >= 0;
          }
          if (inside) height = t[0].z - (n.x * (step.proxy.x - t[0].x) + n.y * (step.proxy.y - t[0].y)) / n.z;
        }
        ASSERT_FALSE(std::isnan(height)) << frame << ": it left the plate";
        ASSERT_GT(side * (step.proxy.z - height), radius) << frame;
      }
    }
}

TEST(HapticProbe, stays_outside_of_a_body_that_deforms) {
  Random random(11);
  int touched = 0, jammed = 0, steps = 0;
  for (const auto& held : test::placed_bodies()) {
    PlacedBody& body = *held;
    if (body.name != "limb" && body.name != "torus") continue;
    body.collider.set_transform({});
    const double size = body.collider.sphere_state().sphere(0).radius;
    for (const double radius : {0.0, 0.02 * size}) {
      body.deform(body.mesh.positions);
      HapticProbe probe({.radius = radius});
      ASSERT_TRUE(probe.step(body.collider, {3 * size, 3 * size, 3 * size}).status);
      Vec3 device;
      for (int frame = 0; frame < 40; ++frame) {
        // Waves that travel through the body.
        std::vector<Vec3> moved = body.mesh.positions;
        for (Vec3& p : moved) {
          const double phase = 0.3 * frame;
          p += 0.1 * size *
               Vec3{std::sin(2 * p.y / size + phase), std::sin(3 * p.z / size + 1.3 * phase),
                    std::cos(2 * p.x / size + phase)};
        }
        body.deform(moved);
        if (frame % 8 == 0) {  // below a facet
          const Facet& f = body.mesh.facets[static_cast<std::size_t>(random.uniform(0, 1) * 0.999 *
                                                                     static_cast<double>(body.mesh.facets.size()))];
          const Triangle corners{moved[f[0]], moved[f[1]], moved[f[2]]};
          device = at_barycentric(corners, {0.3, 0.3, 0.4}) - 0.04 * size * normalized(area_vector(corners));
        }
        const HapticStep step = probe.step(body.collider, device);
        ASSERT_TRUE(step.status);
        touched += step.touches, jammed += step.jammed, ++steps;
        ASSERT_NEAR(test::slow_winding(body.collider, step.proxy), 0, 1e-3) << body.name << ", frame " << frame;
        ASSERT_NO_FATAL_FAILURE(expect_clear_path(probe, body, radius, 0x1p-20 * size, body.name));
      }
    }
    body.deform(body.mesh.positions);
  }
  EXPECT_GT(touched, steps / 3);
  EXPECT_EQ(jammed, 0);
}

TEST(HapticProbe, reports_a_surface_that_closes_around_it) {
  // Two plates meet, with the ball between them.
  const Mesh below = test::grid_plate(4), above = test::translated(test::inverted(below), {0, 0, 1});
  PlacedBody body(test::joined(below, above));
  HapticProbe probe({.radius = 0.1});
  ASSERT_TRUE(probe.step(body.collider, {0.5, 0.5, 0.5}).status);
  std::vector<Vec3> closed = body.mesh.positions;
  for (Vec3& p : closed) p.z = p.z > 0.5 ? 0.3 : 0.2;
  body.deform(closed);
  HapticStep step = probe.step(body.collider, {0.5, 0.5, 0.5});
  ASSERT_TRUE(step.status);
  EXPECT_FALSE(step.jammed);  // the center still has room
  EXPECT_GT(step.proxy.z, 0.2);
  EXPECT_LT(step.proxy.z, 0.3);
  for (Vec3& p : closed) p.z = p.z > 0.25 ? 0.1 : 0.4;  // through each other
  body.deform(closed);
  step = probe.step(body.collider, {0.5, 0.5, 0.5});
  ASSERT_TRUE(step.status);
  EXPECT_TRUE(step.jammed);
}

TEST(HapticProbe, has_the_same_bits_on_copies_of_the_body) {
  const Mesh mesh = sample_body("limb", 24);
  PlacedBody one(mesh), first(mesh), second(mesh);
  HapticProbe on_one({.radius = 0.03}), on_two({.radius = 0.03});
  Random random(13);
  Vec3 device{2, 2, 2};
  for (int k = 0; k < 60; ++k) {
    PlacedBody& slot = k / 5 % 2 == 0 ? first : second;
    if (k % 5 == 0) {
      const std::vector<Vec3> moved = test::rippled(mesh.positions, 0.03, static_cast<std::uint64_t>(k));
      one.deform(moved), slot.deform(moved);
    }
    device = k == 0 ? device : 0.5 * device + test::random_point(random, 0.3);
    const HapticStep a = on_one.step(one.collider, device), b = on_two.step(slot.collider, device);
    ASSERT_TRUE(a.status && b.status);
    EXPECT_EQ(a.proxy, b.proxy) << k;
    EXPECT_EQ(a.force, b.force) << k;
  }
}

TEST(HapticProbe, follows_another_body_at_the_same_address_with_the_same_frame) {
  const Mesh mesh = test::grid_plate(6);
  const CoveredTree model = build(mesh, {.method = Method::grid, .depth = 2});
  std::vector<Vec3> positions = mesh.positions;
  std::optional<Body> body(std::in_place, mesh, model);
  ASSERT_TRUE(body->update(positions));
  HapticProbe probe({.radius = 0.01});
  {
    const Collider collider(mesh, *body);
    ASSERT_TRUE(probe.step(collider, {0.5, 0.5, 0.2}).status);
    ASSERT_TRUE(settle(probe, collider, {0.5, 0.5, -0.2}).settled);
  }
  body.reset();
  for (Vec3& p : positions) p.z = 0.5;
  body.emplace(mesh, model);
  ASSERT_TRUE(body->update(positions));
  const Collider collider(mesh, *body);
  const HapticStep step = settle(probe, collider, {0.5, 0.5, -0.2});
  ASSERT_TRUE(step.status);
  EXPECT_FALSE(step.jammed);
  EXPECT_NEAR(step.proxy.z, 0.51, 1e-4);
}

TEST(HapticProbe, follows_a_body_that_is_updated_from_the_same_array) {
  const Mesh mesh = test::grid_plate(6);
  std::vector<Vec3> positions = mesh.positions;
  Body body(mesh, build(mesh, {.method = Method::grid, .depth = 2}));
  const Collider collider(mesh, body);
  HapticProbe probe({.radius = 0.01});
  ASSERT_TRUE(body.update(positions));
  ASSERT_TRUE(probe.step(collider, {0.5, 0.5, 0.2}).status);
  for (int frame = 0; frame < 10; ++frame) {
    const double height = 0.3 * std::sin(frame);
    for (Vec3& p : positions) p.z = height;
    ASSERT_TRUE(body.update(positions));
    EXPECT_NEAR(settle(probe, collider, {0.5, 0.5, -1}).proxy.z, height + 0.01, 1e-4) << frame;
  }
}

}  // namespace
}  // namespace morula
