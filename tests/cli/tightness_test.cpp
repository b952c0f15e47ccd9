// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <commands/bounds/tightness.hpp>

namespace morula::test {
namespace {

/// Points whose distance from the center is a whole number, scaled by powers of two: on the sphere to the bit.
TEST(Tightness, a_point_is_outside_as_soon_as_it_is_beyond_the_last_bit) {
  for (const double scale : {1.0, 0x1p-60, 0x1p60})
    for (const double away : {0.0, 0x1p20, -0x1p30}) {
      const Vec3 center{away * scale, -away * scale, 3 * scale};
      const Sphere sphere{center, 7 * scale};
      const Vec3 on = center + Vec3{2 * scale, 3 * scale, 6 * scale};
      EXPECT_FALSE(cli::is_outside(sphere, on));
      EXPECT_TRUE(cli::is_outside(sphere, {on.x, on.y, std::nextafter(on.z, 1e300)}));
      EXPECT_FALSE(cli::is_outside(sphere, {on.x, on.y, std::nextafter(on.z, -1e300)}));
      EXPECT_TRUE(cli::is_outside({center, std::nextafter(7 * scale, 0)}, on));
    }
  EXPECT_TRUE(cli::is_outside({{0, 0, 0}, 1}, {std::nan(""), 0, 0}));
}

TEST(Tightness, counts_points_outside_of_sphere_or_box_and_compares_radii) {
  cli::Tightness tightness;
  const std::vector<Vec3> points{{-1, 0, 0}, {1, 0, 0}, {0, 0.5, 0}};
  tightness.add({{0, 0, 0}, 1}, {{-1, 0, 0}, {1, 0.5, 0}}, points);
  EXPECT_EQ(tightness.uncovered_count(), 0u);
  tightness.add({{0, 0, 0}, 2}, {{-1, 0, 0}, {1, 0.25, 0}}, points);
  EXPECT_EQ(tightness.uncovered_count(), 1u);
  tightness.add({{0.5, 0, 0}, 1}, {{-1, -1, -1}, {1, 1, 1}}, points);
  EXPECT_EQ(tightness.uncovered_count(), 2u);
  EXPECT_EQ(tightness.sphere_count(), 3u);
  const cli::Json report = tightness.json();
  EXPECT_EQ(report["uncovered_corners"], 2);
  EXPECT_EQ(report["radius_over_smallest"]["median"], 1);
  EXPECT_EQ(report["radius_over_smallest"]["largest"], 2);
}

}  // namespace
}  // namespace morula::test
