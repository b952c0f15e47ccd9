// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <morula/accuracy/measure.hpp>
#include <morula/geometry/reproducible.hpp>
#include <numbers>
#include <vector>

namespace morula {
namespace {

TEST(UnionMass, agrees_with_formulas_of_balls_and_lenses) {
  const Sphere ball{{3, -2, 5}, 0.7};
  const UnionMass one = union_mass(std::span(&ball, 1));
  const double volume_of_ball = 4 * std::numbers::pi * 0.7 * 0.7 * 0.7 / 3;
  EXPECT_NEAR(one.volume, volume_of_ball, 2e-3 * volume_of_ball);
  EXPECT_LT(distance(one.center, ball.center), 1e-12);
  for (const std::size_t axis : {0, 3, 5})
    EXPECT_NEAR(one.inertia[axis], 0.4 * volume_of_ball * 0.49, 5e-3 * 0.4 * volume_of_ball * 0.49);
  for (const std::size_t mixed : {1, 2, 4}) EXPECT_NEAR(one.inertia[mixed], 0, 1e-12);
  // Two unit balls, centers 1 apart along x: their lens has the volume 5 pi / 12.
  const std::vector<Sphere> pair{{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{0.5, 0, 0}, 0.3}};
  const UnionMass two = union_mass(pair);
  const double expected = 8 * std::numbers::pi / 3 - 5 * std::numbers::pi / 12;
  EXPECT_NEAR(two.volume, expected, 2e-3 * expected);
  EXPECT_LT(distance(two.center, {0.5, 0, 0}), 1e-3);
  EXPECT_EQ(union_mass({}).volume, 0);
}

/// Points thrown at random into the box of the spheres: an oracle that knows no columns.
TEST(UnionMass, agrees_with_points_thrown_at_random) {
  Random random(7);
  std::vector<Sphere> spheres;
  for (int i = 0; i < 12; ++i) {
    const Vec3 center{random.uniform(), 2 * random.uniform(), 0.5 * random.uniform()};
    spheres.push_back({center, 0.2 + 0.3 * random.uniform()});
  }
  constexpr int count = 400'000;
  double hits = 0;
  Vec3 first{};
  std::vector<Vec3> inside;
  for (int i = 0; i < count; ++i) {
    const Vec3 p{4 * random.uniform() - 1.5, 4 * random.uniform() - 1, 4 * random.uniform() - 1.75};
    bool is_inside = false;
    for (const Sphere& s : spheres) is_inside = is_inside || distance(p, s.center) <= s.radius;
    if (!is_inside) continue;
    ++hits;
    first += p;
    inside.push_back(p);
  }
  const ConvergedMass mass = converged_union_mass(spheres);
  EXPECT_LE(mass.change, 1e-4);
  const double volume = 64 * hits / count;
  EXPECT_NEAR(mass.solid.volume, volume, 0.02 * volume);
  EXPECT_LT(distance(mass.solid.center, first / hits), 0.01);
  std::array<double, 6> inertia{};
  for (const Vec3& p : inside) {
    const Vec3 d = p - first / hits;
    const double w = 64.0 / count;
    const std::array<double, 6> one{d.y * d.y + d.z * d.z, -d.x * d.y, -d.x * d.z,
                                    d.x * d.x + d.z * d.z, -d.y * d.z, d.x * d.x + d.y * d.y};
    for (std::size_t k = 0; k < 6; ++k) inertia[k] += w * one[k];
  }
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(mass.solid.inertia[k], inertia[k], 0.03 * inertia[0]) << k;
}

TEST(UnionMass, converges_to_the_formula_of_a_ball) {
  const Sphere ball{{-1, 40, 3}, 2.5};
  const ConvergedMass mass = converged_union_mass(std::span(&ball, 1));
  const double volume = 4 * std::numbers::pi * 2.5 * 2.5 * 2.5 / 3;
  EXPECT_NEAR(mass.solid.volume, volume, 2e-4 * volume);
  for (const std::size_t axis : {0, 3, 5}) {
    EXPECT_NEAR(mass.solid.inertia[axis], 0.4 * volume * 6.25, 2e-4 * 0.4 * volume * 6.25);
  }
  EXPECT_EQ(converged_union_mass({}).solid.volume, 0);
}

}  // namespace
}  // namespace morula
