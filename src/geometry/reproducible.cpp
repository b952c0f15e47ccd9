// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <utility>

namespace morula {
namespace {

// Taylor polynomials on |x| ≤ π/4: the first term left out is below 1e-18 of the leading one.
double sin_near_zero(double x) {
  const double q = x * x;
  double sum = 0;
  for (int k = 17; k >= 3; k -= 2) sum = (1 + sum) * (-q / (k * (k - 1)));
  return x + x * sum;
}
double cos_near_zero(double x) {
  const double q = x * x;
  double sum = 0;
  for (int k = 18; k >= 2; k -= 2) sum = (1 + sum) * (-q / (k * (k - 1)));
  return 1 + sum;
}

// The arctangent of a power series on |r| ≤ 1/16: the first term left out is below 2⁻⁵⁹ of the leading one.
double angle_near_zero(double r) {
  const double q = r * r;
  double sum = 0;
  for (int k = 13; k >= 3; k -= 2) sum = q * (1.0 / k - sum);
  return r - r * sum;
}

// The angle of a point with 0 ≤ short_leg ≤ long_leg, not both 0: the angle of the nearest multiple k / 8 of its slope
// is in a table, and the rest is small. With c for k / 8, (s - c l) / (l + c s) is the tangent of the difference.
double angle_below_diagonal(double short_leg, double long_leg) {
  // atan(k / 8)
  constexpr double table[9]{0,
                            0x1.fd5ba9aac2f6ep-4,
                            0x1.f5b75f92c80ddp-3,
                            0x1.6f61941e4def1p-2,
                            0x1.dac670561bb4fp-2,
                            0x1.1e00babdefeb4p-1,
                            0x1.4978fa3269ee1p-1,
                            0x1.700a7c5784634p-1,
                            0x1.921fb54442d18p-1};
  const int k = static_cast<int>(8 * (short_leg / long_leg) + 0.5);
  const double c = k / 8.0;
  return table[k] + angle_near_zero((short_leg - c * long_leg) / (long_leg + c * short_leg));
}

}  // namespace

SinCos sin_cos(double radians) {
  if (!std::isfinite(radians)) return {std::nan(""), std::nan("")};
  // Whole turns of the double nearest to 2π are subtracted exactly. Below that limit the number of quarter turns fits
  // an integer.
  if (std::abs(radians) > 0x1p30) radians = std::remainder(radians, 0x1.921fb54442d18p+2);
  // π/2 in three parts of 33 bits or fewer: products with small integers are exact.
  constexpr double high = 0x1.921fb544p+0, middle = 0x1.0b4611a6p-34, low = 0x1.3198a2e037073p-69;
  const double turns = std::nearbyint(radians * 0.63661977236758134308);
  const double x = ((radians - turns * high) - turns * middle) - turns * low;
  const double s = sin_near_zero(x), c = cos_near_zero(x);
  switch (static_cast<long long>(turns) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

double angle_of(double y, double x) {
  constexpr double half_turn = 0x1.921fb54442d18p+1, half_turn_rest = 0x1.1a62633145c07p-53;
  if (std::isnan(x) || std::isnan(y)) return x + y;
  double along = std::abs(x), across = std::abs(y);
  const bool is_steep = across > along;
  if (is_steep) std::swap(along, across);
  double angle = 0;
  if (along > 0) {
    if (std::isinf(along)) across = std::isinf(across) ? 1 : 0, along = 1;
    // Products must neither overflow nor lose digits. Scaling by powers of two changes no digit.
    if (along > 0x1p+1000) along *= 0x1p-100, across *= 0x1p-100;
    if (along < 0x1p-900) along *= 0x1p+100, across *= 0x1p+100;
    angle = angle_below_diagonal(across, along);
  }
  if (is_steep) angle = 0.5 * half_turn - (angle - 0.5 * half_turn_rest);
  if (std::signbit(x)) angle = half_turn - (angle - half_turn_rest);
  return std::copysign(angle, y);
}

}  // namespace morula
