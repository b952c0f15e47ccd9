// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/geometry/trigonometry.hpp>

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

}  // namespace

SinCos sin_cos(double radians) {
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

}  // namespace morula
