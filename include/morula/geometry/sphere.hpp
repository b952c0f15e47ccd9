// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres, and rounded_up_radius(), which makes a radius safe against rounding.
#pragma once

#include <morula/geometry/vector.hpp>
#include <numbers>

namespace morula {

/// A sphere as a closed ball: it contains the points of its surface. Radii are at least 0.
template <class Scalar>
struct BasicSphere {
  Vector3<Scalar> center{};
  Scalar radius{};

  constexpr bool operator==(const BasicSphere&) const = default;
};

using Sphere = BasicSphere<double>;
using Spheref = BasicSphere<float>;
static_assert(sizeof(Spheref) == 16 && sizeof(Sphere) == 32, "spheres are written and read as packed arrays");

/// The power of a point x: |x − c|² − r², in squared units of length; negative inside, 0 on the surface, positive
/// outside. The points of equal power with respect to two spheres of different centers form a plane.
inline double power(const Sphere& s, const Vec3& x) {
  return squared_distance(s.center, x) - s.radius * s.radius;
}

/// 4/3 π r³.
inline double volume(const Sphere& s) {
  return 4.0 / 3.0 * std::numbers::pi * s.radius * s.radius * s.radius;
}

/// The radius of a sphere that contains all points whose distance from its center, as computed in double, is at most
/// `farthest_distance`. It exceeds that distance by a pad of 2⁻⁴⁸ of both arguments.
///
/// largest_coordinate: a bound of the |coordinates| of the points and of the center. The pad exceeds all errors of the
/// computed distance: each difference of coordinates is off by at most 2⁻⁵² of this bound, the coordinates of a cut
/// point (a weighted sum of vertices) by at most four times that, and the square root of the sum by a few units in the
/// last place.
inline double rounded_up_radius(double farthest_distance, double largest_coordinate) {
  // mutant radius-coordinates: `(1.0 + 0x1p-48) + largest_coordinate * 0x1p-48` -> `(1.0 + 0x1p-48)`
  // mutant radius-coordinates-less: `48;` -> `54;`
  // mutant radius-as-measured: `farthest_distance ... + 0x1p-48) + largest_coordinate * 0x1p-48` -> `farthest_distance`
  return farthest_distance * (1.0 + 0x1p-48) + largest_coordinate * 0x1p-48;
}

}  // namespace morula
