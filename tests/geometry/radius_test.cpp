// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The one way a radius survives rounding, at its limit; of headers alone.
#include <gtest/gtest.h>

#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sphere.hpp>

namespace morula {
namespace {

using Wide = Vector3<long double>;

Vec3 random_vector(Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}

// Points on both sides of the origin, as far from each other as coordinates allow: what counts is the distance's own
// rounding. And close to each other far away, where differences are exact.
TEST(RoundedUpRadius, contains_a_point_at_the_distance_that_was_measured) {
  Random random(1);
  for (int round = 0; round < 100000; ++round) {
    const Vec3 p = random_vector(random), c = random_vector(random);
    const double radius = rounded_up_radius(distance(c, p), std::max(max_norm(p), max_norm(c)));
    ASSERT_LE(length(Wide(p) - Wide(c)), static_cast<long double>(radius)) << round;
  }
}

// Cut points: sums of three products, rounded by a few units in the last place of coordinates that are all alike, and
// so near the center that the distance pays for nothing.
TEST(RoundedUpRadius, contains_a_cut_point_that_was_rounded_where_it_is) {
  Random random(2);
  for (int round = 0; round < 100000; ++round) {
    const Vec3 about{1 + 0.9 * random.uniform(), 1 + 0.9 * random.uniform(), 1 + 0.9 * random.uniform()};
    Vec3 v[3];
    for (Vec3& p : v) p = about + 0x1p-30 * random_vector(random);
    const double a = random.uniform(0, 0.5), b = random.uniform(0, 0.5), c = 1 - a - b;
    const Vec3 rounded = v[0] * c + v[1] * a + v[2] * b;
    const Wide real = Wide(v[0]) * static_cast<long double>(c) + Wide(v[1]) * static_cast<long double>(a) +
                      Wide(v[2]) * static_cast<long double>(b);
    const Vec3 center = rounded + 0x1p-51 * random_vector(random);
    const double radius = rounded_up_radius(distance(center, rounded), max_norm(about));
    ASSERT_LE(length(real - Wide(center)), static_cast<long double>(radius)) << round;
  }
}

}  // namespace
}  // namespace morula
