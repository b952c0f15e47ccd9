// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rigid tools of balls: their ways, sampled densely in time, against all facets by brute force; and tools at rest whose
// poses are known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/surface/haptic_tool.hpp>
#include <optional>
#include <span>
#include <string>
#include <support/allocations.hpp>
#include <support/error_text.hpp>
#include <support/meshes.hpp>
#include <support/numbers.hpp>
#include <support/transforms.hpp>

#include "../collide/placed_bodies.hpp"

namespace morula {
namespace {

using test::PlacedBody;

/// The least gap between a ball and a facet, with the body's present positions.
double slow_gap(const PlacedBody& body, std::span<const Sphere> balls, const RigidTransform& pose) {
  double least = test::infinity;
  for (const Sphere& ball : balls) {
    const Vec3 p = pose(ball.center);
    for (const Facet& f : body.mesh.facets)
      least = std::min(
          least, test::slow_segment_distance(p, p, {body.positions[f[0]], body.positions[f[1]], body.positions[f[2]]}) -
                     ball.radius);
  }
  return least;
}

/// The pose after a share of the screw motion between two: the center moves straight while the tool rotates evenly.
RigidTransform between(const RigidTransform& from, const RigidTransform& to, const Vec3& center, double share) {
  std::array<Vec3, 3> r;  // columns of to × fromᵀ are the images of axes
  const std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  for (std::size_t k = 0; k < 3; ++k) r[k] = to.rotate(from.inverse_rotate(axes[k]));
  const Vec3 twist{r[1].z - r[2].y, r[2].x - r[0].z, r[0].y - r[1].x};
  const double angle = std::atan2(length(twist), r[0].x + r[1].y + r[2].z - 1);
  const RigidTransform turn = RigidTransform::from_axis(twist, share * angle);
  RigidTransform pose;
  std::array<Vec3, 3> columns;
  for (std::size_t k = 0; k < 3; ++k) columns[k] = turn.rotate(from.rotate(axes[k]));
  for (int k = 0; k < 3; ++k) pose.rows[static_cast<std::size_t>(k)] = {columns[0][k], columns[1][k], columns[2][k]};
  const Vec3 a = from(center), b = to(center);
  pose.translation = a + share * (b - a) - pose.rotate(center);
  return pose;
}

/// Checks that no ball meets a facet on the way of the last step, after it followed the surface.
void expect_free_way(const HapticTool& tool, const PlacedBody& body, std::span<const Sphere> balls, double skin,
                     const std::string& what, int samples = 5, double share = 0.7) {
  const double least = share * skin;
  const auto path = tool.path();
  for (std::size_t k = 2; k < path.size(); ++k)
    for (int s = k == 2 ? 0 : 1; s <= samples; ++s) {
      const RigidTransform pose = between(path[k - 1], path[k], tool.center(), static_cast<double>(s) / samples);
      ASSERT_GT(slow_gap(body, balls, pose), least) << what << ", move " << k - 1 << ", sample " << s;
    }
}

HapticToolStep settle(HapticTool& tool, const Collider& body, const RigidTransform& device, int most = 200) {
  HapticToolStep step = tool.step(body, device);
  for (int k = 0; k < most && step.status && !step.settled; ++k) step = tool.step(body, device);
  return step;
}

std::vector<Sphere> bar(int count, double length, double radius) {
  std::vector<Sphere> balls;
  for (int k = 0; k < count; ++k) balls.push_back({{length * (k / (count - 1.0) - 0.5), 0, 0}, radius});
  return balls;
}

TEST(HapticTool, never_meets_a_facet_however_far_the_device_jumps) {
  Random random(3);
  int touched = 0, steps = 0;
  for (const auto& held : test::placed_bodies()) {
    PlacedBody& body = *held;
    body.deform(body.mesh.positions);
    body.collider.set_transform({});
    const Sphere root = body.collider.sphere_state().sphere(0);
    std::vector<Sphere> balls{{{}, 0}};
    for (int k = 0; k < 5; ++k)
      balls.push_back({test::random_point(random, 0.2 * root.radius), random.uniform(0, 0.04) * root.radius});
    const double skin = 1e-3 * root.radius;
    HapticTool tool(balls, {.skin = skin});
    RigidTransform device;
    for (int k = 0; k < 30; ++k) {
      device = k == 0       ? RigidTransform{.translation = root.center + Vec3{3 * root.radius, 0, 0}}
               : k % 3 == 1 ? test::random_transform(random, 0.5 * root.radius, root.center)
                            : device;
      const HapticToolStep step = tool.step(body.collider, device);
      ASSERT_TRUE(step.status) << message(step.status);
      EXPECT_TRUE(step.certified);
      ASSERT_FALSE(step.jammed);
      ASSERT_NO_FATAL_FAILURE(expect_free_way(tool, body, balls, skin, body.name + ", step " + std::to_string(k)));
      touched += step.touches, ++steps;
    }
  }
  EXPECT_GT(touched, steps / 3);
}

TEST(HapticTool, stays_on_its_side_of_a_thin_sheet_with_any_rotation) {
  PlacedBody sheet(test::translated(test::grid_plate(6, 2, 2), {-1, -1, 0}));
  const std::vector<Sphere> balls = bar(5, 0.4, 0.03);
  Random random(4);
  for (const double side : {1.0, -1.0}) {
    HapticTool tool(balls, {.skin = 1e-4});
    ASSERT_FALSE(tool.step(sheet.collider, {.translation = {0, 0, side * 0.5}}).jammed);
    for (int k = 0; k < 40; ++k) {
      RigidTransform device = test::random_transform(random, 0.2);
      device.translation.z = k % 4 == 3 ? side * 0.4 : -side * 0.5;
      const HapticToolStep step = settle(tool, sheet.collider, device, 3);
      for (const Sphere& ball : balls) ASSERT_GT(side * step.proxy(ball.center).z, ball.radius) << k;
      ASSERT_NO_FATAL_FAILURE(expect_free_way(tool, sheet, balls, 1e-4, "step " + std::to_string(k), 3));
    }
  }
}

TEST(HapticTool, lies_flat_on_a_plate_with_the_force_and_torque_of_normal_forces) {
  PlacedBody plate(test::translated(test::grid_plate(9, 2, 2), {-1, -1, 0}));
  std::vector<Sphere> balls;
  for (const double x : {-0.2, 0.2})
    for (const double y : {-0.1, 0.1})
      for (const double z : {0.0, 0.1}) balls.push_back({{x, y, z}, 0.02});
  const double skin = 1e-4, stiffness = 50;
  HapticTool tool(balls, {.skin = skin, .stiffness = stiffness});
  EXPECT_LT(distance(tool.center(), {0, 0, 0.05}), 1e-15);
  ASSERT_FALSE(tool.step(plate.collider, {.translation = {0, 0, 0.3}}).jammed);
  RigidTransform device = RigidTransform::from_axis({0, 1, 0}, 0.05, {0.1, 0.2, -0.1});
  const HapticToolStep step = settle(tool, plate.collider, device);
  EXPECT_TRUE(step.settled && step.touches);
  EXPECT_EQ(step.contacts.size(), 4u);
  for (const ToolContact& contact : step.contacts) {
    EXPECT_NEAR(contact.normal.z, 1, 1e-9);
    EXPECT_NEAR(contact.distance, 0.02 + skin, skin / 8);
    EXPECT_NEAR(contact.point.point.z, 0, 1e-12);
    EXPECT_LT(distance(step.proxy(balls[contact.ball].center), contact.point.point), 0.02 + 2 * skin);
  }
  for (const Sphere& ball : balls) EXPECT_NEAR(step.proxy(ball.center).z, ball.center.z + 0.02 + skin, skin);
  EXPECT_LT(std::hypot(step.force.x, step.force.y), 0.05 * stiffness * skin);
  EXPECT_NEAR(step.force.z, stiffness * (step.proxy(tool.center()).z - device(tool.center()).z), 1e-9);
  // Inertia per mass about y: the mean of x² + z², and that of the balls, by formula; the tool turns by -0.05.
  const double inertia = 0.2 * 0.2 + 0.05 * 0.05 + 0.4 * 0.02 * 0.02;
  EXPECT_NEAR(step.torque.y, -stiffness * inertia * 0.05, 1e-3 * stiffness * inertia * 0.05);
  EXPECT_NEAR(step.torque.x, 0, 1e-4);
  HapticTool other(balls, {.skin = skin, .rotation_stiffness = 3});
  ASSERT_FALSE(other.step(plate.collider, {.translation = {0, 0, 0.3}}).jammed);
  EXPECT_NEAR(settle(other, plate.collider, device).torque.y, -3 * 0.05, 1e-3);
}

TEST(HapticTool, turns_a_lever_against_a_wall_until_it_is_held) {
  // A wall at x = 0.5; the lever turns about z so that its end comes there, and its center is pulled back.
  Mesh wall = test::grid_plate(8, 4, 4);
  for (Vec3& p : wall.positions) p = {0.5, p.x - 2, p.y - 2};
  PlacedBody body(wall);
  const std::vector<Sphere> balls = bar(9, 1.6, 0.05);
  const double skin = 1e-4;
  HapticTool tool(balls, {.skin = skin});
  const double start = test::pi / 2;
  ASSERT_FALSE(tool.step(body.collider, RigidTransform::from_axis({0, 0, 1}, start)).jammed);
  HapticToolStep step;
  for (double angle = start; angle > 0.2; angle -= 0.02) {
    step = tool.step(body.collider, RigidTransform::from_axis({0, 0, 1}, angle));
    ASSERT_NO_FATAL_FAILURE(expect_free_way(tool, body, balls, skin, "angle " + std::to_string(angle), 3));
  }
  step = settle(tool, body.collider, RigidTransform::from_axis({0, 0, 1}, 0.2));
  EXPECT_TRUE(step.settled);
  ASSERT_EQ(step.contacts.size(), 1u);
  EXPECT_EQ(step.contacts[0].ball, 8u);
  EXPECT_LT(step.force.x, 0);
  EXPECT_GT(step.torque.z, 0);
  // One contact holds it: the torque is that of the force at the end.
  const Vec3 arm = step.proxy(balls[8].center) - step.proxy(tool.center());
  EXPECT_LT(distance(step.torque, cross(arm, step.force)), 2e-3 * length(step.torque));
}

TEST(HapticTool, keeps_a_peg_in_its_hole) {
  // A tube of 24 sides around z, inside of radius 0.1 or a little less.
  Mesh tube = test::grid_plate(24, 1, 1);
  for (Vec3& p : tube.positions) {
    const double angle = 2 * test::pi * p.x;
    p = {0.1 * std::cos(angle), 0.1 * std::sin(angle), p.y - 0.5};
  }
  PlacedBody hole(tube);
  std::vector<Sphere> peg;
  for (int k = 0; k < 7; ++k) peg.push_back({{0, 0, 0.1 * k}, 0.09});
  const double skin = 1e-4;
  HapticTool tool(peg, {.skin = skin});
  ASSERT_FALSE(tool.step(hole.collider, {.translation = {0, 0, 0.7}}).jammed);
  EXPECT_TRUE(settle(tool, hole.collider, {.translation = {0, 0, 0.2}}).settled);
  Random random(6);
  double deepest = 1;
  for (int k = 0; k < 60; ++k) {
    const Vec3 axis{random.uniform(-1, 1), random.uniform(-1, 1), 0};
    const RigidTransform device = RigidTransform::from_axis(
        axis, random.uniform(0, 0.5), {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 0.2 - 0.05 * (k % 12)});
    const HapticToolStep step = tool.step(hole.collider, device);
    ASSERT_FALSE(step.jammed);
    ASSERT_NO_FATAL_FAILURE(expect_free_way(tool, hole, peg, skin, "step " + std::to_string(k), 3));
    deepest = std::min(deepest, step.proxy(peg[0].center).z);
    for (const Sphere& ball : peg) {
      const Vec3 p = step.proxy(ball.center);
      if (std::abs(p.z) < 0.5) {
        ASSERT_LT(std::hypot(p.x, p.y), 0.01) << k;
      }
    }
  }
  EXPECT_LT(deepest, -0.1);
}

TEST(HapticTool, stays_outside_of_a_body_that_deforms) {
  Random random(11);
  int touched = 0, jammed = 0, steps = 0;
  for (const auto& held : test::placed_bodies()) {
    PlacedBody& body = *held;
    if (body.name != "limb" && body.name != "torus") continue;
    body.collider.set_transform({});
    body.deform(body.mesh.positions);
    const double size = body.collider.sphere_state().sphere(0).radius, skin = 1e-3 * size;
    const std::vector<Sphere> balls = bar(6, 0.4 * size, 0.03 * size);
    HapticTool tool(balls, {.skin = skin});
    ASSERT_FALSE(tool.step(body.collider, {.translation = {3 * size, 3 * size, 3 * size}}).jammed);
    RigidTransform device;
    for (int frame = 0; frame < 40; ++frame) {
      std::vector<Vec3> moved = body.mesh.positions;
      for (Vec3& p : moved) {
        const double phase = 0.3 * frame;
        p += 0.1 * size *
             Vec3{std::sin(2 * p.y / size + phase), std::sin(3 * p.z / size + 1.3 * phase),
                  std::cos(2 * p.x / size + phase)};
      }
      body.deform(moved);
      if (frame % 8 == 0) {
        device = test::random_transform(random, 0);
        const Facet& f =
            body.mesh
                .facets[static_cast<std::size_t>(random.uniform(0, 1) * static_cast<double>(body.mesh.facets.size()))];
        device.translation = (moved[f[0]] + moved[f[1]] + moved[f[2]]) / 3;
      }
      const HapticToolStep step = tool.step(body.collider, device);
      ASSERT_TRUE(step.status);
      touched += step.touches, jammed += step.jammed, ++steps;
      if (step.jammed) continue;
      ASSERT_GT(slow_gap(body, balls, step.proxy), 0) << body.name << ", frame " << frame;
      for (const Sphere& ball : balls)
        ASSERT_NEAR(test::slow_winding(body.collider, step.proxy(ball.center)), 0, 1e-3) << frame;
      ASSERT_NO_FATAL_FAILURE(expect_free_way(tool, body, balls, skin, body.name, 2, 0.2));
    }
    body.deform(body.mesh.positions);
  }
  EXPECT_GT(touched, steps / 3);
  EXPECT_EQ(jammed, 0);
}

TEST(HapticTool, is_pushed_by_a_plate_that_moves_and_tilts) {
  const Mesh mesh = test::translated(test::grid_plate(6), {-0.5, -0.5, 0});
  for (const double side : {1.0, -1.0}) {
    PlacedBody body(mesh);
    const std::vector<Sphere> balls = bar(4, 0.3, 0.02);
    HapticTool tool(balls, {.skin = 1e-4});
    ASSERT_FALSE(tool.step(body.collider, {.translation = {0, 0, side * 0.2}}).jammed);
    for (int frame = 0; frame < 60; ++frame) {
      std::vector<Vec3> moved = mesh.positions;
      const double height = 0.3 * std::sin(0.5 * frame), tilt = 0.3 * std::sin(0.35 * frame);
      for (Vec3& p : moved) p.z = height + tilt * p.x;
      body.deform(moved);
      const HapticToolStep step = tool.step(body.collider, {.translation = {0, 0, side * 0.05}});
      ASSERT_FALSE(step.jammed) << frame;
      for (const Sphere& ball : balls) {
        const Vec3 p = step.proxy(ball.center);
        ASSERT_LT(std::hypot(p.x, p.y), 0.5) << "it left the plate";
        ASSERT_GT(side * (p.z - height - tilt * p.x) / std::hypot(1, tilt), ball.radius) << frame;
      }
    }
  }
}

TEST(HapticTool, has_the_same_poses_at_any_scale_and_when_its_body_moves_rigidly) {
  const Mesh mesh = sample_body("limb", 24);
  PlacedBody reference(mesh);
  const double size = reference.collider.sphere_state().sphere(0).radius;
  for (const double scale : {1.0, 0x1p-60, 0x1p50}) {
    Mesh scaled = mesh;
    for (Vec3& p : scaled.positions) p *= scale;
    PlacedBody body(scaled);
    std::vector<Sphere> balls = bar(4, 0.4 * size, 0.05 * size), large = balls;
    for (Sphere& ball : large) ball.center *= scale, ball.radius *= scale;
    HapticTool expected(balls), found(large);
    Random random(9);
    for (int k = 0; k < 40; ++k) {
      const RigidTransform device =
          k == 0 ? RigidTransform{.translation = {0, 0, 3 * size}} : test::random_transform(random, 0.7 * size);
      const HapticToolStep a = expected.step(reference.collider, device);
      RigidTransform moved = device;
      moved.translation *= scale;
      // The scaled body also moves, by a turn about z.
      const RigidTransform world = RigidTransform::from_axis({0, 0, 1}, 0.1 * k, scale * Vec3{1, 2, 3});
      body.collider.set_transform(world);
      const RigidTransform placed = relative_to(inverse(world), moved);
      const HapticToolStep b = found.step(body.collider, placed);
      ASSERT_TRUE(a.status && b.status);
      ASSERT_EQ(a.jammed, b.jammed);
      for (std::size_t n = 0; n < balls.size(); ++n)
        ASSERT_LT(distance(world(scale * a.proxy(balls[n].center)), b.proxy(large[n].center)), 1e-4 * scale * size)
            << k << " " << scale;
    }
  }
}

TEST(HapticTool, follows_the_device_where_it_is_free_from_near_and_from_far) {
  PlacedBody body(test::icosphere(2));
  const std::vector<Sphere> balls = bar(3, 0.6, 0.1);
  HapticTool tool(balls);
  for (const Vec3& at : {Vec3{2, 0, 0}, Vec3{0, 0, 3}, Vec3{1e9, 0, 0}, Vec3{-1e30, 1e12, 0}, Vec3{0, 1.7, 0}}) {
    const RigidTransform device = RigidTransform::from_axis(at, 1.0, at);
    const HapticToolStep step = settle(tool, body.collider, device);
    ASSERT_TRUE(step.status && step.settled) << at.x;
    EXPECT_LE(distance(step.proxy.translation, device.translation), 1e-15 * (1 + length(at)));
    EXPECT_LE(length(step.force), 1e-15 * (1 + length(at)));
    EXPECT_LE(length(step.torque), 1e-12);
    EXPECT_FALSE(step.touches);
  }
  for (const double far : {1e3, 1e9, 1e15}) {
    tool.reset();
    ASSERT_FALSE(tool.step(body.collider, {.translation = {far, 0, 0}}).jammed);
    const HapticToolStep step = settle(tool, body.collider, {.translation = {0.2, 0, 0}});
    EXPECT_TRUE(step.touches) << far;
    for (const Sphere& ball : balls) EXPECT_GT(length(step.proxy(ball.center)), 1.05) << far;
    // The device is far beyond the body.
    const HapticToolStep held = settle(tool, body.collider, {.translation = {-far, 0, 0}}, 3);
    for (const Sphere& ball : balls) EXPECT_GT(length(held.proxy(ball.center)), 1.05) << far;
  }
}

TEST(HapticTool, follows_a_turn_in_place_though_no_center_of_a_ball_moves) {
  PlacedBody plate(test::translated(test::grid_plate(8, 2, 2), {-1, -1, 0}));
  for (const double radius : {0.1, 1e-170, 0.0})
    for (const double height : {0.5, 50.0})
      for (const std::optional<double>& rotation_stiffness : {std::optional<double>{}, std::optional(3.0)}) {
        const Sphere ball{{}, radius};
        HapticTool tool(std::span(&ball, 1), {.rotation_stiffness = rotation_stiffness});
        ASSERT_FALSE(tool.step(plate.collider, {.translation = {0, 0, height}}).jammed);
        const RigidTransform device = RigidTransform::from_axis({1, 2, 0}, 2.0, {0, 0, height});
        const HapticToolStep step = settle(tool, plate.collider, device);
        EXPECT_TRUE(step.settled);
        EXPECT_LT(length(step.torque), 1e-12) << radius << " " << height;
        for (std::size_t row = 0; row < 3; ++row) EXPECT_LT(distance(step.proxy.rows[row], device.rows[row]), 1e-12);
      }
}

TEST(HapticTool, of_one_ball_slides_whatever_its_radius) {
  PlacedBody plate(test::translated(test::grid_plate(8, 2, 2), {-1, -1, 0}));
  for (const double radius : {0.1, 1e-150, 1e-170, 1e-300, 0.0}) {
    const Sphere ball{{}, radius};
    HapticTool tool(std::span(&ball, 1));
    ASSERT_FALSE(tool.step(plate.collider, {.translation = {0, 0, 0.5}}).jammed);
    const HapticToolStep step =
        settle(tool, plate.collider, RigidTransform::from_axis({0, 1, 0}, 1.0, {0.5, 0.25, -0.5}));
    EXPECT_TRUE(step.settled && step.touches) << radius;
    EXPECT_LT(distance(step.proxy.translation, {0.5, 0.25, radius}), 1e-3) << radius;
    EXPECT_LT(length(step.torque), 0.1) << radius;
  }
}

TEST(HapticTool, may_make_any_number_of_moves) {
  PlacedBody plate(test::translated(test::grid_plate(8, 2, 2), {-1, -1, 0}));
  const std::vector<Sphere> balls = bar(3, 0.4, 0.03);
  for (const std::size_t most : {std::size_t{1} << 40, std::size_t{1} << 62, ~std::size_t{0}}) {
    HapticTool tool(balls, {.max_moves = most});
    ASSERT_FALSE(tool.step(plate.collider, {.translation = {0, 0, 0.5}}).jammed);
    EXPECT_TRUE(tool.step(plate.collider, RigidTransform::from_axis({0, 1, 0}, 1.0, {0, 0, -0.5})).settled);
  }
}

TEST(HapticTool, does_not_cut_a_body_that_its_center_passes_by) {
  PlacedBody body(test::icosphere(2));
  const std::vector<Sphere> balls = bar(5, 1.2, 0.05);
  HapticTool tool(balls, {.skin = 1e-3});
  for (int k = 0; k < 6; ++k) {
    const Vec3 at{k % 2 == 0 ? -3.0 : 3.0, 1.1 + 0.1 * k, 0};
    const HapticToolStep step = tool.step(body.collider, RigidTransform::from_axis({0, 0, 1}, test::pi / 2, at));
    ASSERT_FALSE(step.jammed);
    ASSERT_NO_FATAL_FAILURE(expect_free_way(tool, body, balls, 1e-3, std::to_string(k), 30));
    tool.reset();
    ASSERT_FALSE(tool.step(body.collider, RigidTransform::from_axis({0, 0, 1}, test::pi / 2, {at.x, at.y, 0})).jammed);
  }
}

TEST(HapticTool, starts_off_the_surface_and_reports_a_jam) {
  const Mesh below = test::grid_plate(4), above = test::translated(test::inverted(below), {0, 0, 1});
  PlacedBody body(test::joined(below, above));
  HapticTool tool(bar(3, 0.3, 0.1), {.skin = 1e-4});
  const RigidTransform reaches{.translation = {0.5, 0.5, 0.05}}, middle{.translation = {0.5, 0.5, 0.5}};
  HapticToolStep step = tool.step(body.collider, reaches);
  ASSERT_TRUE(step.status);
  EXPECT_TRUE(step.jammed);
  EXPECT_EQ(step.proxy.translation, reaches.translation);
  EXPECT_EQ(length(step.force), 0);
  EXPECT_FALSE(tool.step(body.collider, middle).jammed);
  // Plates that leave less room than the tool needs.
  std::vector<Vec3> closed = body.mesh.positions;
  for (Vec3& p : closed) p.z = p.z > 0.5 ? 0.58 : 0.42;
  body.deform(closed);
  step = tool.step(body.collider, middle);
  EXPECT_TRUE(step.jammed);
  EXPECT_EQ(length(step.force), 0);
  EXPECT_TRUE(tool.step(body.collider, middle).jammed);
  for (Vec3& p : closed) p.z = p.z > 0.5 ? 0.7 : 0.3;
  body.deform(closed);
  EXPECT_FALSE(tool.step(body.collider, middle).jammed);
}

TEST(HapticTool, rejects_bad_input_by_name) {
  using Code = Status::Code;
  const std::vector<Sphere> balls = bar(2, 0.2, 0.05);
  const auto error = [](std::span<const Sphere> given, const HapticToolOptions& options) {
    return test::error_text([&] { HapticTool tool(given, options); });
  };
  EXPECT_EQ(error(balls, {}), "");
  EXPECT_NE(error({}, {}).find("ball"), std::string::npos);
  for (const Sphere& bad : {Sphere{{test::nan, 0, 0}, 1}, Sphere{{}, -1}, Sphere{{}, test::infinity}})
    EXPECT_NE(error(std::span(&bad, 1), {}).find("ball 0"), std::string::npos);
  EXPECT_NE(error(balls, {.skin = 0.0}).find("HapticToolOptions::skin"), std::string::npos);
  EXPECT_NE(error(balls, {.stiffness = -1}).find("HapticToolOptions::stiffness"), std::string::npos);
  EXPECT_NE(error(balls, {.rotation_stiffness = test::nan}).find("rotation_stiffness"), std::string::npos);
  EXPECT_NE(error(balls, {.max_moves = 0}).find("HapticToolOptions::max_moves"), std::string::npos);

  PlacedBody body(test::icosphere(1)), other(test::icosphere(2));
  HapticTool tool(balls);
  RigidTransform bent;
  bent.rows[0].x = 1.1;
  for (const RigidTransform& bad :
       {bent, RigidTransform{.translation = {test::nan, 0, 0}}, RigidTransform{.translation = {0, 0, 0x1p200}}})
    EXPECT_EQ(tool.step(body.collider, bad).status.code, Code::bad_shape);
  const RigidTransform free{.translation = {2, 0, 0}};
  ASSERT_TRUE(tool.step(body.collider, free).status);
  EXPECT_EQ(tool.step(other.collider, free).status.code, Code::other_bodies);
  EXPECT_EQ(tool.step(Collider(body.body.sphere_state()), free).status.code, Code::no_surface);
  HapticTool fine(balls, {.skin = 1e-12});
  EXPECT_EQ(fine.step(body.collider, free).status.code, Code::bad_option);
}

TEST(HapticTool, has_the_leaf_spheres_of_a_body_that_cover_its_mesh) {
  PlacedBody tool(test::box_mesh({-1, -1, -1}, {1, 1, 1}, 4));
  const std::vector<Sphere> balls = leaf_spheres(tool.body.sphere_state());
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    Vec3 p = test::random_point(random, 1);
    p[k % 3] = k % 2 == 0 ? 1 : -1;
    EXPECT_TRUE(std::any_of(balls.begin(), balls.end(),
                            [&](const Sphere& b) { return distance(b.center, p) <= b.radius * (1 + 1e-12); }));
  }
}

TEST(HapticTool, allocates_nothing_once_warm) {
  PlacedBody body(sample_body("limb", 24));
  HapticTool tool(bar(5, 0.4, 0.03));
  const std::vector<Vec3> moved = test::rippled(body.mesh.positions, 0.02, 3);
  const auto scene = [&] {
    for (int k = 0; k < 40; ++k) {
      if (k % 10 == 0 && !body.body.update(k % 20 == 0 ? moved : body.mesh.positions)) FAIL();
      const double angle = 0.16 * k;
      ASSERT_TRUE(tool.step(body.collider,
                            RigidTransform::from_axis({1, 2, 3}, angle, {std::sin(angle), 0, k % 20 < 3 ? 2 : 0.2}))
                      .status);
    }
  };
  EXPECT_EQ(test::allocations_once_warm(scene), 0u);
}

}  // namespace
}  // namespace morula
