// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The parts that examples of responses share, where no example goes: bodies that are held, and free rotation.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <morula/morula.hpp>
#include <vector>

#include "../../examples/response/rigid_body.hpp"
#include "../../examples/response/soft_body.hpp"
#include "../../examples/response/xpbd.hpp"

namespace {

using morula::Vec3;

/// A cube of 1 that reaches 0.01 into a plate below z = 0; points for which is_held(p) are held.
template <class IsHeld>
std::vector<Vec3> solved_on_plate(const IsHeld& is_held, Vec3& push) {
  response::RigidBody plate(response::box({-2, -2, -1}, {2, 2, 0}));
  response::SoftBody cube({2, 2, 2}, 1.0, [](double i, double j, double k) {
    return Vec3{i / 2 - 0.5, j / 2 - 0.5, k / 2 - 0.01};
  });
  for (std::size_t p = 0; p < cube.x.size(); ++p)
    if (is_held(cube.x[p])) cube.mass[p] = std::numeric_limits<double>::infinity();
  cube.update_surface();
  morula::ContactPatchQuery query(cube.collider, plate.collider);
  EXPECT_TRUE(query.run());
  EXPECT_EQ(query.patches().size(), 1u);
  for (const morula::ContactPatch& patch : query.patches()) push += response::solve_points(patch, &cube, nullptr, 0.5);
  std::vector<Vec3> moved = cube.x;
  for (std::size_t p = 0; p < moved.size(); ++p) moved[p] -= cube.old[p];
  return moved;
}

TEST(Response, PointsThatAreHeldStay) {
  Vec3 push;
  for (const Vec3& by : solved_on_plate([](const Vec3& p) { return p.z < 0; }, push)) EXPECT_EQ(by, Vec3{});
  EXPECT_EQ(push, Vec3{});
}

TEST(Response, HalfHeldBodyIsPushedOutWhereItIsFree) {
  Vec3 push;
  double highest = 0;
  for (const Vec3& by : solved_on_plate([](const Vec3& p) { return p.x < 0; }, push)) {
    EXPECT_TRUE(std::isfinite(by.x) && std::isfinite(by.y) && std::isfinite(by.z));
    highest = std::max(highest, by.z);
  }
  EXPECT_GT(highest, 0);
  EXPECT_GT(push.z, 0);
}

// Six particles on the axes stand for the body: their momentum and energy need no inertia.
TEST(Response, FreeRotationKeepsMomentumAndEnergy) {
  constexpr double mass = 0.5;
  const Vec3 reach{1.3, 1, 0.4};
  const auto square = [](double x) { return 2 * mass * x * x; };
  response::RigidBody body(response::box({-1, -1, -1}, {1, 1, 1}));
  body.inertia = {square(reach.y) + square(reach.z), square(reach.x) + square(reach.z),
                  square(reach.x) + square(reach.y)};
  body.spin = {0.1, 5, 0.1};  // about the middle axis, which does not stay
  const auto measure = [&](Vec3& momentum) {
    double energy = 0;
    momentum = {};
    for (int k = 0; k < 3; ++k)
      for (const double sign : {-1.0, 1.0}) {
        Vec3 at;
        at[k] = sign * reach[k];
        const Vec3 p = body.collider.transform()(at), v = body.velocity_at(p);
        momentum += mass * cross(p, v), energy += 0.5 * mass * squared_length(v);
      }
    return energy;
  };
  Vec3 before, after;
  const double energy = measure(before);
  double least = 1;
  for (int step = 0; step < 20000; ++step) {
    body.advance(0.001, {}, {});
    least = std::min(least, body.collider.transform().rotate({0, 1, 0}).y);
    if (step % 1000 != 999) continue;
    EXPECT_NEAR(measure(after), energy, 1e-4 * energy);
    EXPECT_LT(distance(before, after), 1e-6 * length(before));
  }
  EXPECT_LT(least, -0.9) << "it did not tumble";
}

}  // namespace
