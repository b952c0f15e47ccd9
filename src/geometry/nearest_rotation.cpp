// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <morula/geometry/nearest_rotation.hpp>
#include <stdexcept>
#include <string>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

// Newton's iteration for the polar factor without an inverse: R <- (3 I - R R^T) R / 2. It keeps the singular vectors
// of R and takes a singular value 1 + e to 1 - 3/2 e^2 - 1/2 e^3, so that the limit is the nearest rotation. A
// deviation of 1e-5 leaves |e| <= 1.5e-5 (R R^T differs from I by at most three times that in norm), then 3.4e-10,
// then 2e-19: two steps reach rounding, the third removes what the first two rounded.
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
