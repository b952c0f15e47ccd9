// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Radii rounded up to float.
#include "update/points/rounding.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <vector>

namespace morula {
using namespace detail;
namespace {

TEST(Rounding, rounded_up_is_the_least_float_not_below) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.uniform() * std::exp2(random.uniform(-140, 120));
    const float up = rounded_up(x);
    EXPECT_GE(static_cast<double>(up), x);
    EXPECT_LT(static_cast<double>(std::nextafter(up, 0.0f)), x);
  }
  EXPECT_EQ(rounded_up(0.5), 0.5f);
  EXPECT_EQ(rounded_up(0.0), 0.0f);
}

// Zeros, subnormal numbers, both ends of the range, infinities, negative numbers; every exponent, on and beside floats.
TEST(Rounding, rounded_up_is_what_nextafter_says_for_every_kind_of_number) {
  constexpr double beyond_all = std::numeric_limits<double>::infinity();
  std::vector<double> numbers{0.0,
                              beyond_all,
                              std::numeric_limits<double>::denorm_min(),
                              0x1p-149,
                              0x1p-150,
                              0x1p-126,
                              0x1.fffffep127,
                              0x1.ffffffp127,
                              0x1.fffffefffffffp127,
                              1e300};
  for (int exponent = -160; exponent <= 130; ++exponent)
    for (const double mantissa : {1.0, 1.0 + 0x1p-23, 1.0 + 0x1p-24, 1.0 + 0x1p-25, 2.0 - 0x1p-23, 2.0 - 0x1p-24})
      numbers.push_back(std::ldexp(mantissa, exponent));
  for (const double magnitude : numbers)
    for (const double beside : {std::nextafter(magnitude, 0.0), magnitude, std::nextafter(magnitude, beyond_all)})
      for (const double x : {beside, -beside}) {
        const float nearest = static_cast<float>(x);
        const float expected = static_cast<double>(nearest) < x
                                   ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
                                   : nearest;
        EXPECT_EQ(std::bit_cast<std::uint32_t>(rounded_up(x)), std::bit_cast<std::uint32_t>(expected)) << x;
      }
  EXPECT_TRUE(std::isnan(rounded_up(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace morula
