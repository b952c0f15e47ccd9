// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Points of shapes that are in spheres, tested one by one.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <morula/geometry/reproducible.hpp>
#include <morula/robot/fit.hpp>

namespace morula::test {

/// Expects many points of the link's surface in its spheres, whose numbers are read as Scalar.
template <class Scalar>
void expect_covered(const robot::LinkSpheres& link, std::uint64_t seed) {
  Random random(seed);
  const auto is_in = [&](const Vec3& p) {
    return std::any_of(link.spheres.begin(), link.spheres.end(), [&](const Sphere& s) {
      const Vector3<Scalar> center(s.center);
      const auto radius = static_cast<double>(static_cast<Scalar>(s.radius));
      return distance(Vec3(center), p) <= radius;
    });
  };
  const Mesh& mesh = link.surface.mesh;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    for (int k = 0; k < 40; ++k) {
      double u = k < 3 ? (k == 1) : random.uniform(), v = k < 3 ? (k == 2) : random.uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      EXPECT_TRUE(is_in(a + u * (b - a) + v * (c - a))) << f;
    }
  }
  for (const Sphere& own : link.surface.spheres) {
    for (int k = 0; k < 200; ++k) {
      const Vec3 way = normalized(Vec3{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
      EXPECT_TRUE(is_in(own.center + own.radius * way));
    }
  }
}

/// Expects that of every link, as double and as float, and figures that say so.
inline void expect_covered(const robot::RobotSpheres& fitted) {
  EXPECT_TRUE(fitted.covered());
  for (const robot::LinkSpheres& link : fitted.links) {
    expect_covered<double>(link, 1);
    expect_covered<float>(link, 2);
    EXPECT_EQ(link.figures.uncovered_distance, 0);
  }
}

}  // namespace morula::test
