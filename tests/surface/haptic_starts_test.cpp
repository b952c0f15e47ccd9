// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The haptic probe where it starts on the surface, and where it has little room, by all facets.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <morula/surface/haptic_probe.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <span>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "haptic_steps.hpp"

namespace morula {
namespace {

using test::PlacedBody;
using test::settle;
using test::slow_clearance;

/// Two plates along y that meet at x = z = 0, at an angle of `half` above and below the plane z = 0.
Mesh wedge(double half) {
  const auto plate = [&](double sign) {
    Mesh made = test::grid_plate(6, 1, 2);
    for (Vec3& p : made.positions) p = {p.x * std::cos(half), p.y - 1, sign * p.x * std::sin(half)};
    return made;
  };
  return test::joined(plate(1), test::inverted(plate(-1)));
}

TEST(HapticProbe, leaves_a_wedge_in_which_it_starts_nearer_than_rounding_of_its_skin) {
  const double half = 0.2, skin = 1e-4;
  PlacedBody body(wedge(half));
  for (const double radius : {0.0, 0.02})
    for (const double start : {skin / 65, skin / 300, skin / 5000, 1e-12}) {
      const Vec3 device{start / std::sin(half), 0, 0};
      HapticProbe probe({.radius = radius, .skin = skin});
      const HapticStep step = settle(probe, body.collider, device);
      ASSERT_TRUE(step.status);
      EXPECT_TRUE(step.settled) << start;
      EXPECT_FALSE(step.jammed);
      EXPECT_NEAR(step.proxy.x, (radius + skin) / std::sin(half), skin) << start;
      EXPECT_NEAR(step.proxy.z, 0, skin) << start;
    }
}

TEST(HapticProbe, leaves_facets_edges_and_vertices_that_it_starts_on) {
  int tested = 0;
  for (const auto& held : test::placed_bodies()) {
    PlacedBody& body = *held;
    body.deform(body.mesh.positions);
    body.collider.set_transform({});
    const double skin = 1e-5 * body.collider.sphere_state().sphere(0).radius;
    HapticProbe probe({.skin = skin});
    for (std::size_t k = 0; k < body.mesh.facets.size(); k += body.mesh.facets.size() / 12 + 1) {
      const Facet& f = body.mesh.facets[k];
      const Triangle t{body.positions[f[0]], body.positions[f[1]], body.positions[f[2]]};
      for (const Vec3& device : {t[k % 3], 0.5 * (t[0] + t[1]), at_barycentric(t, {0.25, 0.25, 0.5})}) {
        probe.reset();
        const HapticStep step = settle(probe, body.collider, device);
        ASSERT_TRUE(step.status);
        EXPECT_FALSE(step.jammed) << body.name << ", facet " << k;
        EXPECT_GT(slow_clearance(body, step.proxy, step.proxy), 0.8 * skin) << body.name << ", facet " << k;
        ++tested;
      }
    }
  }
  EXPECT_GT(tested, 100);
}

TEST(HapticProbe, stays_on_the_side_on_which_it_starts_hardly_off_a_facet) {
  PlacedBody plate(test::translated(test::grid_plate(7), {0, 0, 1}));
  for (const double side : {1.0, -1.0})
    for (const double off : {1e-7, 1e-12, 0x1p-52}) {
      HapticProbe probe({.skin = 1e-5});
      const HapticStep step = settle(probe, plate.collider, {0.31, 0.42, 1 + side * off});
      EXPECT_NEAR(step.proxy.z, 1 + side * 1e-5, 1e-6) << side << " " << off;
    }
  HapticProbe probe({.skin = 1e-5});
  EXPECT_GT(settle(probe, plate.collider, {0.31, 0.42, 1}).proxy.z, 1) << "the outer side of its facet";
}

TEST(HapticProbe, leaves_facets_without_area_that_it_starts_on) {
  Mesh mesh = test::grid_plate(4);
  const std::size_t flat = mesh.facets.size();
  for (const Facet& f : {Facet{6, 7, 8}, Facet{6, 6, 7}, Facet{7, 12, 12}, Facet{11, 11, 11}}) mesh.facets.push_back(f);
  PlacedBody body(mesh);
  for (std::size_t k = flat; k < mesh.facets.size(); ++k) {
    const Facet& f = mesh.facets[k];
    const Vec3 a = mesh.positions[f[0]], b = mesh.positions[f[2]];
    for (const Vec3& device : {a, b, 0.5 * (a + b)}) {
      HapticProbe probe({.skin = 1e-5});
      const HapticStep step = settle(probe, body.collider, device);
      EXPECT_FALSE(step.jammed) << k;
      EXPECT_TRUE(step.settled) << k;
      EXPECT_NEAR(step.proxy.z, 1e-5, 2e-6) << k;
    }
  }
}

TEST(HapticProbe, keeps_no_body_after_a_reset) {
  const Mesh mesh = test::grid_plate(3);
  HapticProbe probe;
  const Sphere ball{{}, 0.05};
  HapticTool tool(std::span(&ball, 1));
  std::weak_ptr<const void> state;
  {
    const Body body(mesh, build(mesh));
    const Collider collider(mesh, body);
    state = body.sphere_state().shared;
    ASSERT_TRUE(probe.step(collider, {0.5, 0.5, 1}).status);
    ASSERT_TRUE(tool.step(collider, {.translation = {0.5, 0.5, 1}}).status);
  }
  probe.reset();
  tool.reset();
  EXPECT_TRUE(state.expired());
}

TEST(HapticProbe, may_make_any_number_of_moves) {
  PlacedBody plate(test::grid_plate(7));
  for (const std::size_t most : {std::size_t{1} << 40, std::size_t{1} << 62, ~std::size_t{0}}) {
    HapticProbe probe({.max_moves = most});
    ASSERT_TRUE(probe.step(plate.collider, {0.5, 0.5, 1}).status);
    EXPECT_TRUE(probe.step(plate.collider, {0.4, 0.3, -1}).settled);
  }
}

TEST(HapticProbe, starts_again_until_it_has_room) {
  // Two plates in one place leave no side: every direction crosses the other one, or nothing is free between them.
  Mesh stack = test::grid_plate(4);
  for (int k = 1; k < 40; ++k) stack = test::joined(stack, test::translated(test::grid_plate(4), {0, 0, 1e-9 * k}));
  PlacedBody body(stack);
  HapticProbe probe({.skin = 1e-6});
  const HapticStep held = probe.step(body.collider, {0.5, 0.5, 20.5e-9});
  ASSERT_TRUE(held.status);
  EXPECT_TRUE(held.jammed);
  EXPECT_FALSE(held.settled);
  const HapticStep again = settle(probe, body.collider, {0.5, 0.5, 0.3});
  EXPECT_FALSE(again.jammed);
  EXPECT_EQ(again.proxy, (Vec3{0.5, 0.5, 0.3}));
}

TEST(HapticProbe, slides_along_a_slot_that_is_narrower_than_its_ball) {
  PlacedBody slot(
      test::joined(test::grid_plate(6), test::translated(test::inverted(test::grid_plate(6)), {0, 0, 0.1})));
  const double skin = 1e-5;
  HapticProbe probe({.radius = 0.2, .skin = skin});
  ASSERT_TRUE(probe.step(slot.collider, {0.5, 0.5, 0.04}).status);
  for (const Vec3& device : {Vec3{0.8, 0.6, 0.04}, Vec3{0.3, 0.3, -2}, Vec3{0.6, 0.2, 3}}) {
    const HapticStep step = settle(probe, slot.collider, device);
    EXPECT_TRUE(step.settled && step.touches);
    EXPECT_LT(distance(step.proxy, {device.x, device.y, 0.05}), 2e-3) << device.x;
  }
}

TEST(HapticProbe, settles_in_edges_and_corners_however_far_the_device_is) {
  PlacedBody box(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 4)), sharp(wedge(0.02));
  for (double far = 1e3; far < 1e16; far *= 10) {
    HapticProbe in_box({.radius = 0.2, .skin = 1e-6});
    ASSERT_TRUE(in_box.step(box.collider, {}).status);
    const HapticStep step = settle(in_box, box.collider, {far, -0.7 * far, 0.3 * far});
    EXPECT_TRUE(step.settled) << far;
    EXPECT_LT(distance(step.proxy, {0.8, -0.8, 0.8}), 1e-5) << far;
    HapticProbe in_wedge({.skin = 1e-4});
    ASSERT_TRUE(in_wedge.step(sharp.collider, {0.5, 0, 0}).status);
    const HapticStep deep = settle(in_wedge, sharp.collider, {-far, 0, 1e-3 * far});
    EXPECT_TRUE(deep.settled) << far;
    EXPECT_NEAR(deep.proxy.x, 1e-4 / std::sin(0.02), 1e-4) << far;
  }
}

TEST(HapticProbe, is_between_plates_that_close_to_nothing_or_says_that_it_is_jammed) {
  const Mesh below = test::grid_plate(4), above = test::translated(test::inverted(below), {0, 0, 1});
  PlacedBody body(test::joined(below, above));
  int between = 0, jammed = 0;
  for (const double tilt : {0.0, 0.1, -0.37})
    for (const double factor : {0.5, 0.3}) {
      body.deform(body.mesh.positions);
      HapticProbe probe;
      const Vec3 device{0.5, 0.51, 0.5};
      ASSERT_TRUE(probe.step(body.collider, device).status);
      double gap = 0.5;
      for (int frame = 0; frame < 60; ++frame, gap *= factor) {
        std::vector<Vec3> closed = body.mesh.positions;
        for (std::size_t v = 0; v < closed.size(); ++v) {
          const double middle = 0.4 + tilt * (closed[v].x - 0.5);
          closed[v].z = body.mesh.positions[v].z > 0.5 ? middle + gap : middle - gap;
        }
        body.deform(closed);
        const HapticStep step = probe.step(body.collider, device);
        ASSERT_TRUE(step.status);
        if (step.jammed) {
          ++jammed;
          break;
        }
        ++between;
        const double middle = 0.4 + tilt * (step.proxy.x - 0.5);
        ASSERT_LT(std::abs(step.proxy.z - middle), gap) << frame << " " << gap;
      }
    }
  EXPECT_GT(between, 60);
  EXPECT_EQ(jammed, 6);
}

}  // namespace
}  // namespace morula
