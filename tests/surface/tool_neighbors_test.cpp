// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The proof that a segment keeps its distance from a facet, against distances by features; poses of tools, against
// matrices.
#include "surface/haptic/tool_neighbors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <support/meshes.hpp>
#include <support/numbers.hpp>
#include <support/transforms.hpp>

#include "../collide/placed_bodies.hpp"

namespace morula {
namespace {

TEST(ToolNeighbors, prove_segments_apart_if_and_only_if_they_are_up_to_rounding) {
  Random random(8);
  int apart = 0, near = 0;
  for (int round = 0; round < 20000; ++round) {
    const Triangle t{test::random_point(random, 1), test::random_point(random, 1), test::random_point(random, 1)};
    const Vec3 from = test::random_point(random, 1.5),
               to = from + test::random_point(random, round % 3 == 0 ? 0.01 : 2);
    const double found = test::slow_segment_distance(from, to, t);
    if (found > 1e-9) {
      EXPECT_FALSE(detail::is_proven_apart(t, from, to, found * (1 + 1e-12))) << round;
      apart += detail::is_proven_apart(t, from, to, 0.99 * found);
      ++near;
    } else {
      EXPECT_FALSE(detail::is_proven_apart(t, from, to, 0)) << round;
    }
  }
  EXPECT_GT(near, 5000);
  EXPECT_GT(apart, 0.98 * near);
}

TEST(ToolNeighbors, prove_ways_of_balls_on_their_side_alone) {
  test::PlacedBody plate(test::grid_plate(5));
  const double skin = 1e-3;
  const std::vector<Sphere> balls{{{-0.2, 0, 0}, 0.05}, {{0.2, 0, 0}, 0.05}};
  const detail::ToolShape shape(balls);
  const std::vector<Vec3> centers{{0.3, 0.5, 0.06}, {0.7, 0.5, 0.06}}, along{{0.35, 0.5, 0.06}, {0.75, 0.5, 0.06}},
      into{{0.3, 0.5, 0.06}, {0.7, 0.5, 0.0503}}, through{{0.3, 0.5, 0.06}, {0.7, 0.5, -0.2}};
  detail::ToolNeighbors neighbors;
  for (const auto* ends : {&along, &into, &through}) {
    ASSERT_TRUE(neighbors.gather(plate.collider, shape, skin, centers, *ends));
    EXPECT_EQ(neighbors.is_proven_free(shape, skin, 0, centers, *ends), ends == &along);
  }
  EXPECT_FALSE(neighbors.is_proven_free(shape, skin, 0.01, centers, along)) << "the sag is more than the gap";
}

TEST(ToolPose, has_the_rotations_of_matrices) {
  Random random(5);
  for (int round = 0; round < 2000; ++round) {
    const Vec3 axis = normalized(test::random_point(random, 1));
    const double angle = round % 4 == 0 ? test::pi - random.uniform(0, 1e-9) : random.uniform(0, 3.1);
    const RigidTransform t = RigidTransform::from_axis(axis, angle);
    const detail::Rotation found = detail::Rotation::from_rows(t);
    EXPECT_LT(distance(found.vector(), angle * axis), 1e-8) << round;
    const RigidTransform again = detail::Rotation::from_vector(angle * axis).rows();
    const Vec3 p = test::random_point(random, 1);
    EXPECT_LT(distance(again(p), t(p)), 1e-14);
    EXPECT_LT(distance(found.rows()(p), t(p)), 1e-14);
    const RigidTransform u = test::random_transform(random, 0);
    const detail::Rotation both = found.after(detail::Rotation::from_rows(u));
    EXPECT_LT(distance(both.rows()(p), t(u(p))), 1e-14);
  }
}

}  // namespace
}  // namespace morula
