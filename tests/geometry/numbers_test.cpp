// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Trigonometry, random numbers and samples: the same on every machine, and right.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/random.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/geometry/trigonometry.hpp>

namespace morula {
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
  for (const SurfaceSample& s : samples) {
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
