// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Penetration volume: lenses of balls, boxes in boxes, random points with their winding numbers.
#include <gtest/gtest.h>

#include <morula/collide/penetration.hpp>
#include <numbers>
#include <support/meshes.hpp>
#include <support/numbers.hpp>

#include "placed_bodies.hpp"

namespace morula {
namespace {

using test::PlacedBody;

/// Of two balls whose centers are d apart.
double lens(double r, double s, double d) {
  if (d >= r + s) return 0;
  if (d <= std::abs(r - s)) return 4.0 / 3.0 * std::numbers::pi * std::pow(std::min(r, s), 3);
  const double u = r + s - d;
  return std::numbers::pi * u * u * (d * d + 2 * d * (r + s) - 3 * (r - s) * (r - s)) / (12 * d);
}

TEST(Penetration, of_balls_is_their_lens) {
  // The polyhedron lies between a ball through its vertices and the largest one inside.
  const Mesh mesh = test::icosphere(2);
  double inner = 1;
  for (const Facet& f : mesh.facets) {
    const Vec3 n = area_vector({mesh.positions[f[0]], mesh.positions[f[1]], mesh.positions[f[2]]});
    inner = std::min(inner, dot(n, mesh.positions[f[0]]) / length(n));
  }
  ASSERT_GT(inner, 0.9);
  PlacedBody a(mesh), b(mesh);
  PenetrationQuery query(a.collider, b.collider);
  for (const double d : {0.0, 0.4, 1.1, 1.7, 1.99, 2.5}) {
    a.collider.set_transform(RigidTransform::from_axis({1, 2, 3}, d, {100, 0.3, 0.1}));
    b.collider.set_transform(RigidTransform::from_axis({3, 1, 0}, 1 - d, Vec3{100, 0.3, 0.1} + Vec3{0.6, 0, 0.8} * d));
    const Penetration p = query.run({.tolerance = 0.4, .budget = d < 1.5 ? 20000 : 2000});
    ASSERT_TRUE(p.status && p.certified);
    EXPECT_LE(p.lower, lens(1, 1, d) + 1e-12);
    EXPECT_GE(p.upper, lens(inner, inner, d));
    EXPECT_LE(p.lower, p.estimate);
    EXPECT_LE(p.estimate, p.upper);
    if (d >= 2) {
      EXPECT_EQ(p.upper, 0) << "they are apart";
      EXPECT_TRUE(p.finished);
    } else if (d < 1.5) {
      EXPECT_TRUE(p.finished);
      EXPECT_GE(p.lower, 0.6 * p.upper);
      EXPECT_GT(p.estimate, 0.9 * lens(inner, inner, d));
      EXPECT_LT(p.estimate, 1.1 * lens(1, 1, d));
      const Vec3 middle = Vec3{100, 0.3, 0.1} + Vec3{0.3, 0, 0.4} * d;
      EXPECT_LT(length(p.center - middle), 0.05);
    }
  }
}

TEST(Penetration, of_boxes_is_a_box) {
  const Mesh cube = test::box_mesh({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, 2);
  const Box extent = bounding_box(cube);
  const Vec3 side = extent.extent();
  PlacedBody a(cube), b(cube);
  PenetrationQuery query(a.collider, b.collider);
  for (const Vec3& shift : {Vec3{0, 0, 0}, Vec3{0.25, 0.5, 0.125}, Vec3{-0.7, 0.1, 0.3}, Vec3{0.9, -0.9, 0.9}}) {
    const RigidTransform turn = RigidTransform::from_axis({1, -1, 2}, 0.8, {-3, 5, 2});
    const Vec3 by{shift.x * side.x, shift.y * side.y, shift.z * side.z};
    a.collider.set_transform(turn);
    b.collider.set_transform(RigidTransform{turn.rows, turn(by)});
    const double expected = (side.x - std::abs(by.x)) * (side.y - std::abs(by.y)) * (side.z - std::abs(by.z));
    const Penetration p = query.run({.tolerance = 0.5, .budget = 20000});
    ASSERT_TRUE(p.status);
    EXPECT_LE(p.lower, expected);
    EXPECT_GE(p.upper, expected);
    EXPECT_GT(p.lower, 0);
  }
  // One wholly inside the other: its own volume.
  PlacedBody small(test::scaled(cube, 0.25));
  const Vec3 middle = extent.center();
  small.collider.set_transform(RigidTransform::from_axis({0, 0, 1}, 0, middle - middle * 0.25));
  a.collider.set_transform({});
  PenetrationQuery inside(a.collider, small.collider);
  const Penetration p = inside.run({.tolerance = 0.3, .budget = 30000});
  const double expected = side.x * side.y * side.z / 64;
  EXPECT_TRUE(p.finished);
  EXPECT_LE(p.lower, expected);
  EXPECT_GE(p.upper, expected);
  EXPECT_NEAR(p.estimate, expected, 0.15 * expected);
}

// 0 says that nothing is shared: it is not to come of volumes that no double holds.
TEST(Penetration, of_bodies_whose_volume_no_double_holds_is_not_nothing) {
  const Mesh one = test::box_mesh({-1, -1, -1}, {1, 1, 1}), other = test::box_mesh({0, 0, 0}, {2, 2, 2});
  PlacedBody a(one), b(other);
  PenetrationQuery query(a.collider, b.collider);
  for (const double size : {1e-60, 1e-100, 1e-106, 1e-107, 1e-110, 1e-150}) {
    const Mesh small = test::scaled(one, size), small_other = test::scaled(other, size);
    ASSERT_TRUE(a.body.update(small.positions));
    ASSERT_TRUE(b.body.update(small_other.positions));
    const Penetration p = query.run({.tolerance = 0, .budget = 2000});
    ASSERT_TRUE(p.status) << size;
    EXPECT_GT(p.upper, 0) << size;
    EXPECT_GE(p.upper, size * size * size) << size;
    EXPECT_LE(p.lower, size * size * size) << size;
  }
}

TEST(Penetration, of_deformed_bodies_holds_what_random_points_find_at_every_interruption) {
  Random random(9);
  std::vector<std::unique_ptr<PlacedBody>> bodies;
  bodies.push_back(std::make_unique<PlacedBody>(test::icosphere(2)));
  bodies.push_back(std::make_unique<PlacedBody>(test::uv_sphere(11, 7, 0.7)));
  for (auto& body : bodies) body->deform(test::rippled(body->mesh.positions, 0.08, 5));
  PlacedBody &a = *bodies[0], &b = *bodies[1];
  a.collider.set_transform(RigidTransform::from_axis({1, 0, 1}, 0.5, {10, 20, 30}));
  b.collider.set_transform(RigidTransform::from_axis({0, 1, 1}, 2, {10.5, 20.2, 30.1}));
  Box box;
  for (std::uint32_t v = 0; v < b.mesh.vertex_count(); ++v) box.add(b.collider.vertex(v));
  constexpr int points = 3000;
  int hits = 0;
  for (int i = 0; i < points; ++i) {
    const Vec3 x{random.uniform(box.lower.x, box.upper.x), random.uniform(box.lower.y, box.upper.y),
                 random.uniform(box.lower.z, box.upper.z)};
    hits += std::abs(test::slow_winding(b.collider, x)) > 0.5 && std::abs(test::slow_winding(a.collider, x)) > 0.5;
  }
  const Vec3 e = box.extent();
  const double all = e.x * e.y * e.z, share = static_cast<double>(hits) / points;
  const double expected = all * share, error = 5 * all * std::sqrt(share * (1 - share) / points);
  ASSERT_GT(hits, 100);

  PenetrationQuery query(a.collider, b.collider);
  Penetration p = query.run({.tolerance = 0.25, .budget = 200});
  std::size_t calls = 1;
  double lower = 0, upper = test::infinity;
  for (;; ++calls) {
    ASSERT_TRUE(p.status);
    ASSERT_LT(calls, 1000u);
    EXPECT_LE(p.probes, 200u);
    EXPECT_LE(p.lower, expected + error);
    EXPECT_GE(p.upper, expected - error);
    EXPECT_GE(p.lower, lower) << "more work narrows";
    EXPECT_LE(p.upper, upper * (1 + 1e-12));
    lower = p.lower, upper = p.upper;
    if (p.finished) break;
    p = query.resume({.tolerance = 0.25, .budget = 200});
  }
  EXPECT_GT(calls, 4u);
  EXPECT_NEAR(p.estimate, expected, error + 0.05 * expected);
  const Penetration whole = query.run({.tolerance = 0.25});
  EXPECT_EQ(whole.lower, p.lower);
  EXPECT_EQ(whole.upper, p.upper);

  // Of the least budgets, too: every resume() divides a cell.
  std::int64_t looks = 0;
  const Clock clock = [&looks] { return std::chrono::seconds(++looks); };
  for (const Budget& least : {Budget(1), Budget(std::chrono::nanoseconds(1))}) {
    p = query.run({.tolerance = 0.25, .budget = least, .clock = clock});
    for (calls = 0; !p.finished; ++calls) {
      ASSERT_LT(calls, 20000u) << "it never ends";
      p = query.resume({.tolerance = 0.25, .budget = least, .clock = clock});
      ASSERT_TRUE(p.status);
      EXPECT_LE(p.probes, 16u);
    }
    EXPECT_EQ(p.lower, whole.lower);
    EXPECT_EQ(p.upper, whole.upper);
  }
  p = query.run({.tolerance = 0.25, .budget = 0});
  EXPECT_EQ(query.resume({.tolerance = 0.25, .budget = 0}).probes, 0u);
  EXPECT_EQ(query.resume({.tolerance = 0.25, .budget = std::chrono::nanoseconds(0)}).probes, 0u);

  EXPECT_EQ(query.run({.tolerance = -1}).status.code, Status::Code::bad_option);
  EXPECT_EQ(query.run({.budget = -1}).status.code, Status::Code::bad_option);
  EXPECT_EQ(PenetrationQuery(a.collider, b.collider).resume().status.code, Status::Code::no_front);
  b.collider.set_transform({});
  EXPECT_EQ(query.resume().status.code, Status::Code::other_transform);
  // Another body of the same tree, in a frame of the same number.
  Body twin_body(b.mesh, b.model);
  while (twin_body.sphere_state().frame < b.body.sphere_state().frame)
    ASSERT_TRUE(twin_body.update(test::rippled(b.mesh.positions, 0.2, 7)));
  ASSERT_EQ(twin_body.sphere_state().frame, b.body.sphere_state().frame);
  ASSERT_TRUE(query.run({.budget = 200}).status);
  const Collider before = b.collider;
  b.collider = Collider(b.mesh, twin_body);
  EXPECT_EQ(query.resume().status, (Status{Status::Code::other_bodies, 1}));
  b.collider = before;
  EXPECT_TRUE(query.resume().status);
  PlacedBody open(test::grid_plate(3));
  EXPECT_THROW(PenetrationQuery(a.collider, open.collider), std::invalid_argument);
}

}  // namespace
}  // namespace morula
