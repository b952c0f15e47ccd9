// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// Only directions matter: vectors are divided by a power of two, which changes no digit, so that no square underflows
// or overflows.
int common_exponent(double largest) {
  return largest > 0 && std::isfinite(largest) ? std::ilogb(largest) : 0;
}

}  // namespace

RigidTransform RigidTransform::from_quaternion(double w, double x, double y, double z, const Vec3& translation) {
  const StandardFloats standard;
  const int exponent = common_exponent(std::max({std::abs(w), std::abs(x), std::abs(y), std::abs(z)}));
  for (double* q : {&w, &x, &y, &z}) *q = std::ldexp(*q, -exponent);
  const double square = w * w + x * x + y * y + z * z;
  RigidTransform t;
  t.translation = translation;
  if (!(square > 0)) return t;
  const double s = 2 / square;
  t.rows = {Vec3{1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
            Vec3{s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
            Vec3{s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
  return t;
}

RigidTransform RigidTransform::from_axis(const Vec3& axis, double angle_radians, const Vec3& translation) {
  const StandardFloats standard;
  const int exponent = common_exponent(max_norm(axis));
  const Vec3 scaled{std::ldexp(axis.x, -exponent), std::ldexp(axis.y, -exponent), std::ldexp(axis.z, -exponent)};
  const double size = length(scaled);
  if (!(size > 0)) return from_quaternion(1, 0, 0, 0, translation);
  const SinCos half = sin_cos(0.5 * angle_radians);
  const Vec3 v = (half.sin / size) * scaled;
  return from_quaternion(half.cos, v.x, v.y, v.z, translation);
}

RigidTransform inverse(const RigidTransform& t) {
  const StandardFloats standard;
  RigidTransform back;
  for (int row = 0; row < 3; ++row)
    back.rows[static_cast<std::size_t>(row)] = {t.rows[0][row], t.rows[1][row], t.rows[2][row]};
  back.translation = -t.inverse_rotate(t.translation);
  return back;
}

RigidTransform relative_to(const RigidTransform& base, const RigidTransform& p) {
  const StandardFloats standard;
  RigidTransform t;
  const RigidTransform back = inverse(base);
  const RigidTransform columns = inverse({p.rows, {}});  // its rows are p's columns
  for (std::size_t row = 0; row < 3; ++row)
    t.rows[row] = {dot(back.rows[row], columns.rows[0]), dot(back.rows[row], columns.rows[1]),
                   dot(back.rows[row], columns.rows[2])};
  t.translation = base.inverse_rotate(p.translation - base.translation);
  return t;
}

double deviation_from_rigid(const RigidTransform& t) {
  constexpr double bad = std::numeric_limits<double>::infinity();
  double worst = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!is_finite(t.rows[i])) return bad;
    for (std::size_t j = 0; j <= i; ++j)
      worst = std::max(worst, std::abs(dot(t.rows[i], t.rows[j]) - (i == j ? 1 : 0)));
  }
  if (!is_finite(t.translation) || !(dot(cross(t.rows[0], t.rows[1]), t.rows[2]) > 0)) return bad;
  return worst;
}

// Newton's iteration for the polar factor without an inverse: R <- (3 I - R R^T) R / 2. It keeps the singular vectors
// of R and takes a singular value 1 + e to 1 - 3/2 e^2 - 1/2 e^3, so that the limit is the nearest rotation. A
// deviation of 1e-5 leaves |e| <= 1.5e-5 (R R^T differs from I by at most three times that in norm), then 3.4e-10, then
// 2e-19: two steps reach rounding, the third removes the rounding of the first two.
RigidTransform orthonormalized(const RigidTransform& t) {
  const StandardFloats standard;
  RigidTransform nearest = t;
  // mutant orthonormalized-less: `3` -> `1`
  for (int step = 0; step < 3; ++step) {
    const std::array<Vec3, 3> rows = nearest.rows;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 products{dot(rows[i], rows[0]), dot(rows[i], rows[1]), dot(rows[i], rows[2])};
      nearest.rows[i] = 1.5 * rows[i] - 0.5 * (products.x * rows[0] + products.y * rows[1] + products.z * rows[2]);
    }
  }
  return nearest;
}

RigidTransform rigid_or_throw(const RigidTransform& t, std::string_view what) {
  const StandardFloats standard;
  const double deviation = deviation_from_rigid(t);
  if (deviation <= largest_rigid_deviation) return t;
  // mutant placed-in-single-precision: `orthonormalized(t)` -> `t`
  if (deviation <= largest_float_deviation) return orthonormalized(t);
  std::string text(what);
  text += " is not a finite rotation and translation: ";
  if (std::isfinite(deviation)) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%.3g", deviation);
    text += std::string("its rows deviate by ") + digits +
            " from unit vectors at right angles, and 1e-05 is allowed; scale and shear have to be in the mesh";
  } else {
    text += "a number is not finite, or it is a reflection";
  }
  throw std::invalid_argument(text);
}

}  // namespace morula
