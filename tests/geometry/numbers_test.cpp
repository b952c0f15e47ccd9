// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trigonometry, random numbers and samples: the same on every machine, and right.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <numbers>

#include "geometry/hash.hpp"

namespace morula {
using namespace detail;
namespace {

TEST(SinCos, agrees_with_extended_precision) {
  EXPECT_EQ(sin_cos(0).sin, 0);
  EXPECT_EQ(sin_cos(0).cos, 1);
  Random random(11);
  for (int i = 0; i < 200000; ++i) {
    const double x = random.uniform(-1, 1) * (i % 3 == 0 ? 1000 : i % 3 == 1 ? 7 : 0.1);
    const SinCos found = sin_cos(x);
    ASSERT_NEAR(found.sin, static_cast<double>(std::sin(static_cast<long double>(x))), 3e-16) << x;
    ASSERT_NEAR(found.cos, static_cast<double>(std::cos(static_cast<long double>(x))), 3e-16) << x;
  }
}

TEST(SinCos, of_any_number_is_of_one_angle_or_none) {
  for (const double x : {1e9, 0x1p30, 0x1.0000001p30, 0x1p63, 1e19, 1.48e109, std::numeric_limits<double>::max()})
    for (const double radians : {x, -x}) {
      const SinCos found = sin_cos(radians);
      EXPECT_NEAR(found.sin * found.sin + found.cos * found.cos, 1, 1e-15) << radians;
      // Whole turns of 2π as a double has it make no difference.
      const SinCos left = sin_cos(std::remainder(radians, 2 * std::numbers::pi));
      EXPECT_NEAR(found.sin, left.sin, 1e-15 + 1e-16 * std::min(std::abs(radians), 0x1p30)) << radians;
      EXPECT_NEAR(found.cos, left.cos, 1e-15 + 1e-16 * std::min(std::abs(radians), 0x1p30)) << radians;
    }
  for (const double none : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_TRUE(std::isnan(sin_cos(none).sin)) << none;
    EXPECT_TRUE(std::isnan(sin_cos(none).cos)) << none;
  }
}

TEST(AngleOf, agrees_with_extended_precision_wherever_the_point_is) {
  Random random(12);
  for (int i = 0; i < 200000; ++i) {
    const double spread = i % 3 == 0 ? 0 : i % 3 == 1 ? 40 : 600;
    const double x = random.uniform(-1, 1) * std::exp2(random.uniform(-spread, spread));
    const double y = random.uniform(-1, 1) * std::exp2(random.uniform(-spread, spread));
    const long double expected = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    if (std::abs(expected) < 1e-300L) continue;  // few digits are left
    ASSERT_NEAR(static_cast<double>(angle_of(y, x) / expected), 1, 5e-16) << y << ' ' << x;
  }
}

TEST(AngleOf, has_the_zeros_and_infinities_of_atan2) {
  const double infinity = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
  const double least = std::numeric_limits<double>::denorm_min();
  for (const double y : {0.0, least, 1e-310, 1.0, 1e308, most, infinity})
    for (const double x : {0.0, least, 1e-310, 1.0, 1e308, most, infinity})
      for (const double sign_y : {1.0, -1.0})
        for (const double sign_x : {1.0, -1.0}) {
          const double found = angle_of(sign_y * y, sign_x * x), expected = std::atan2(sign_y * y, sign_x * x);
          EXPECT_NEAR(found, expected, 5e-16 * std::abs(expected)) << sign_y * y << ' ' << sign_x * x;
          EXPECT_EQ(std::signbit(found), std::signbit(expected)) << sign_y * y << ' ' << sign_x * x;
        }
  EXPECT_TRUE(std::isnan(angle_of(std::nan(""), 1)));
  EXPECT_TRUE(std::isnan(angle_of(1, std::nan(""))));
}

// A golden hash: whatever the compiler, the processor and its library, of which std::atan2 would take its bits.
TEST(AngleOf, and_sin_cos_have_the_same_bits_on_every_machine) {
  Random random(13);
  Hasher hash;
  for (int i = 0; i < 20000; ++i) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    hash.add(angle_of(y, x));
    hash.add(sin_cos(10 * x).sin);
    hash.add(sin_cos(10 * y).cos);
  }
  EXPECT_EQ(hash.value(), 0xb2918869f4bbbbb6u);
}

TEST(Random, is_the_published_sequence_and_uniform) {
  // First outputs of SplitMix64 from seed 0, as printed with the generator's definition.
  Random random(0);
  EXPECT_EQ(random.next(), 0xe220a8397b1dcdafu);
  EXPECT_EQ(random.next(), 0x6e789e6aa1b965f4u);
  double sum = 0, squares = 0;
  constexpr int n = 100000;
  for (int i = 0; i < n; ++i) {
    const double u = random.uniform();
    ASSERT_TRUE(u >= 0 && u < 1);
    sum += u, squares += u * u;
  }
  EXPECT_NEAR(sum / n, 0.5, 0.005);
  EXPECT_NEAR(squares / n, 1.0 / 3, 0.005);
}

TEST(SampleSurface, is_proportional_to_area_and_lies_on_the_facets) {
  const Mesh mesh = sample_body("bar", 8);
  constexpr std::size_t count = 20000;
  const auto samples = sample_surface(mesh, count, 5);
  ASSERT_EQ(samples.size(), count);
  std::vector<double> hits(mesh.facet_count());
  for (const SurfacePoint& s : samples) {
    EXPECT_LT(distance(s.point, at_barycentric(mesh.corners(s.facet), s.barycentric)), 1e-15);
    hits[s.facet] += 1;
  }
  const double total = surface_area(mesh);
  for (std::size_t f = 0; f < mesh.facet_count(); ++f)  // stratified: off by at most two
    EXPECT_NEAR(hits[f], area(mesh.corners(f)) / total * count, 2.0);
  EXPECT_EQ(samples[7].point, sample_surface(mesh, count, 5)[7].point);
  EXPECT_NE(samples[7].point, sample_surface(mesh, count, 6)[7].point);
}

TEST(RoundedUpRadius, contains_points_measured_with_rounding) {
  // Points on a sphere far from the origin: the padded radius must hold them in extended precision too.
  const Vec3 center{1e6 + 0.1, -3e5 + 0.7, 12.3};
  for (const Vec3& d : fibonacci_directions(2000)) {
    const Vec3 p = center + d * 0.37;
    const double radius = rounded_up_radius(distance(center, p), 1e6 + 1);
    const long double dx = static_cast<long double>(p.x) - center.x, dy = static_cast<long double>(p.y) - center.y,
                      dz = static_cast<long double>(p.z) - center.z;
    EXPECT_LT(std::sqrt(dx * dx + dy * dy + dz * dz), static_cast<long double>(radius));
  }
}

}  // namespace
}  // namespace morula
