// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls about the middles of chords, against the known distance to a capsule's and a ring's surface.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <generators/fit/chord_balls.hpp>
#include <morula/geometry/sample_bodies.hpp>
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

// Facets, and samples of them, are this far from the round body.
constexpr double error = 0.06;

template <class Depth>
void expect_inscribed(std::span<const Sphere> balls, double thickest, const Depth& depth) {
  EXPECT_GT(balls.size(), most / 4);
  EXPECT_LE(balls.size(), most);
  double largest = 0;
  for (const Sphere& ball : balls) {
    EXPECT_GT(ball.radius, 0);
    EXPECT_LE(ball.radius, depth(ball.center) + error);
    largest = std::max(largest, ball.radius);
  }
  EXPECT_NEAR(largest, thickest, error);
}

TEST(ChordBalls, are_inscribed_in_a_capsule) {
  expect_inscribed(balls_in(sample_body("capsule", 32)), 0.5, [](const Vec3& p) {
    std::array<double, 3> along{std::abs(p.x), std::abs(p.y), std::abs(p.z)};
    std::sort(along.begin(), along.end());
    return 0.5 - std::hypot(along[0], along[1], std::max(0.0, along[2] - 1));
  });
}

TEST(ChordBalls, are_inscribed_all_around_a_ring) {
  const std::vector<Sphere> balls = balls_in(sample_body("torus", 32));
  expect_inscribed(balls, 0.35, [](const Vec3& p) { return 0.35 - std::hypot(std::hypot(p.x, p.y) - 1, p.z); });
  std::array<int, 12> of_sector{};
  for (const Sphere& ball : balls)
    ++of_sector[static_cast<std::size_t>(6 + 5.999 * std::atan2(ball.center.y, ball.center.x) / M_PI)];
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
