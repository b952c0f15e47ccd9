// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A sphere (closed ball), and the one function that makes its radius safe against rounding.
#pragma once

#include <morula/geometry/vector.hpp>
#include <numbers>

namespace morula {

template <class Scalar>
struct BasicSphere {
  Vector3<Scalar> center{};
  Scalar radius{};

  constexpr bool operator==(const BasicSphere&) const = default;
};

using Sphere = BasicSphere<double>;
using Spheref = BasicSphere<float>;
static_assert(sizeof(Spheref) == 16 && sizeof(Sphere) == 32, "spheres are written and read as packed arrays");

/// |x − c|² − r²: negative inside, zero on the sphere. The difference of two powers is affine in x.
inline double power(const Sphere& s, const Vec3& x) {
  return squared_distance(s.center, x) - s.radius * s.radius;
}

inline double volume(const Sphere& s) {
  return 4.0 / 3.0 * std::numbers::pi * s.radius * s.radius * s.radius;
}

/// A radius that contains points at `farthest_distance` from the center, as measured in double arithmetic, under any
/// rounding: each coordinate difference is off by at most 2⁻⁵³ of the largest |coordinate|, a cut point by four times
/// that, and the distance by a few ulps. `largest_coordinate` bounds |coordinates| of both points and center.
inline double rounded_up_radius(double farthest_distance, double largest_coordinate) {
  // mutant radius-coordinates: `(1.0 + 0x1p-48) + largest_coordinate * 0x1p-48` -> `(1.0 + 0x1p-48)`
  // mutant radius-coordinates-less: `48;` -> `54;`
  // mutant radius-as-measured: `farthest_distance ... + 0x1p-48) + largest_coordinate * 0x1p-48` -> `farthest_distance`
  return farthest_distance * (1.0 + 0x1p-48) + largest_coordinate * 0x1p-48;
}

}  // namespace morula
