// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls about the middles of chords, against the known distance to a capsule's and a ring's surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <generators/fit/chord_balls.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <support/meshes.hpp>

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t most = 200;

std::vector<Sphere> balls_in(const Mesh& mesh) {
  const ObjectShape shape(mesh);
  const ObjectLines lines(mesh, shape, 192, serial_workers());
  return chord_balls(mesh, lines, most, 1);
}

// Facets are this far from the round body.
constexpr double error = 0.01;

// A ball about c reaches to the nearest of 1,000 samples, at most: `depth` of c, where it lies nearer to the surface
// than that, and something for where the samples are not. No disc of two spacings on these bodies is without a sample.
double gap(double area) {
  return 2 * std::sqrt(area / 1000);
}

// depth: of a point in the round body, positive inside. reach: of the ball about a point so deep, at most.
template <class Depth, class Reach>
void expect_about_inscribed(std::span<const Sphere> balls, double thickest, const Depth& depth, const Reach& reach) {
  EXPECT_GT(balls.size(), most / 4);
  EXPECT_LE(balls.size(), most);
  double largest = 0;
  for (const Sphere& ball : balls) {
    const double deep = depth(ball.center);
    EXPECT_GT(deep, -error);
    EXPECT_GT(ball.radius, 0);
    EXPECT_GE(ball.radius, deep - error);
    EXPECT_LE(ball.radius, reach(deep) + error);
    largest = std::max(largest, ball.radius);
  }
  EXPECT_NEAR(largest, thickest, 5 * error);
}

TEST(ChordBalls, are_about_inscribed_in_a_capsule) {
  constexpr double radius = 0.5, length = 2;
  const double s = gap(4 * std::numbers::pi * radius * radius + 2 * std::numbers::pi * radius * length);
  // The body is convex: from the surface's nearest point, samples lie on the near side of the plane across the way to
  // it.
  expect_about_inscribed(
      balls_in(sample_body("capsule", 32)), radius,
      [](const Vec3& p) { return radius - std::hypot(p.y, p.z, std::max(0.0, std::abs(p.x) - length / 2)); },
      [s](double deep) { return std::hypot(std::max(0.0, deep), s); });
}

TEST(ChordBalls, are_about_inscribed_all_around_a_ring) {
  constexpr double ring = 1, tube = 0.35;
  const double s = gap(4 * std::numbers::pi * std::numbers::pi * ring * tube);
  const std::vector<Sphere> balls = balls_in(sample_body("torus", 32));
  expect_about_inscribed(
      balls, tube, [](const Vec3& p) { return tube - std::hypot(std::hypot(p.x, p.y) - ring, p.z); },
      [s](double deep) { return deep + s; });
  std::array<int, 12> of_sector{};
  for (const Sphere& ball : balls)
    ++of_sector[static_cast<std::size_t>(6 + 5.999 * std::atan2(ball.center.y, ball.center.x) / std::numbers::pi)];
  for (const int count : of_sector) EXPECT_GT(count, 0);
}

TEST(ChordBalls, are_few_and_finite_on_every_mesh) {
  for (const test::NamedMesh& body : test::all_meshes()) {
    if (body.mesh.facets.empty()) continue;
    const std::vector<Sphere> balls = balls_in(body.mesh);
    EXPECT_LE(balls.size(), most) << body.name;
    for (const Sphere& ball : balls) EXPECT_TRUE(std::isfinite(ball.radius) && ball.radius >= 0) << body.name;
  }
}

}  // namespace
}  // namespace morula
