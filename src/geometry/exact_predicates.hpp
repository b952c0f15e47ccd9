// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signs of orientation determinants, and whether a sphere contains another: always the results in real numbers, for all
// finite doubles, including denormal ones and ones whose products leave the range of double.
//
// They are computed first in double with a bound of the error [shewchuk1997]; if the value is within its bound, as an
// exact sum of products of integer mantissas in fixed point, wide enough for all exponents. No memory is allocated.
#pragma once

#include <cmath>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>

namespace morula::detail {

/// Two coordinates of points in space: the two left when one axis is dropped.
struct Projection {
  int first, second;
};
inline constexpr Projection projections[3] = {{1, 2}, {2, 0}, {0, 1}};

/// Sign of the triangle a b c, projected along the dropped axis: 1 counter-clockwise, -1 clockwise, 0 on one line. All
/// finite. Cost: 5 to 10 ns; 70 to 90 ns if the points are on one line or nearly so.
int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, Projection projection);

// Products of two differences (1 + e)^3, their difference (1 + e)^4. Allowed: 6 e, and the underflow error as in
// TrianglePlane.
// mutant orient2d-no-error: `6 * 0x1p-53` -> `0`
// mutant orient2d-error-less: `6` -> `1`
inline constexpr double orient2d_relative_error = 6 * 0x1p-53, orient2d_underflow = 0x1p-1000;

/// The same sign, or 0 if doubles alone do not decide it. Cost: 2 ns.
inline int certain_orient2d(const Vec3& a, const Vec3& b, const Vec3& c, Projection projection) {
  const Vec3 u = b - a, v = c - a;
  const auto [first, second] = projection;
  const double left = u[first] * v[second], right = u[second] * v[first], value = left - right;
  const double error = orient2d_relative_error * (std::abs(left) + std::abs(right)) + orient2d_underflow;
  return value > error ? 1 : value < -error ? -1 : 0;
}

/// Whether b is surely beyond the line of an edge of a, projected along the dropped axis. Then they have no common
/// point.
inline bool is_beyond_an_edge(const Triangle& a, const Triangle& b, Projection projection) {
  const int turn = certain_orient2d(a[0], a[1], a[2], projection);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto is_beyond = [&](const Vec3& p) {
      // mutant crossing-beyond-an-edge: `< 0` -> `<= 0`
      return certain_orient2d(a[k], a[(k + 1) % 3], p, projection) * turn < 0;
    };
    // mutant crossing-beyond-any-edge: `(b[1]) && is_beyond(b[2])` -> `(b[1])`
    if (is_beyond(b[0]) && is_beyond(b[1]) && is_beyond(b[2])) return true;
  }
  return false;
}

/// Sign of (b - a) x (d - c), projected along the dropped axis. All finite. Cost: 5 ns; 100 ns if the directions are
/// parallel or nearly so.
int cross2d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Projection projection);

/// Sign of (b - a) x (c - a) . (d - a): 1 when d is on the side from which a b c runs counter-clockwise, 0 when all
/// four are in one plane. All finite. Cost: 10 to 25 ns; 50 to 220 ns if they are in one plane or nearly so.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Whether the one closed ball contains the other, |c - c'| + r' <= r. All numbers are finite, radii at least 0. Cost:
/// 5 ns; 50 to 100 ns if they touch from inside or nearly so.
bool encloses(const Sphere& outer, const Sphere& inner);

/// A triangle's plane for several points: orient3d(t[0], t[1], t[2], d), with the terms that do not depend on d stored.
class TrianglePlane {
 public:
  explicit TrianglePlane(const Triangle& t) : t_(&t) {
    const Vec3 u = t[1] - t[0], v = t[2] - t[0];
    const double yz = u.y * v.z, zy = u.z * v.y, zx = u.z * v.x, xz = u.x * v.z, xy = u.x * v.y, yx = u.y * v.x;
    normal_ = {yz - zy, zx - xz, xy - yx};
    permanent_ = {std::abs(yz) + std::abs(zy), std::abs(zx) + std::abs(xz), std::abs(xy) + std::abs(yx)};
  }

  struct Side {
    int sign;      ///< exact sign
    double value;  ///< six times the tetrahedron's volume, rounded: never of the opposite sign, 0 when the sign is
  };
  Side side(const Vec3& d) const {
    const Side known = certain_side(d);
    return known.sign != 0 ? known : exact_side(d, known.value);
  }
  /// The sign is 0 if doubles alone do not decide it.
  Side certain_side(const Vec3& d) const {
    const Vec3 w = d - (*t_)[0];
    const Vec3 size{std::abs(w.x), std::abs(w.y), std::abs(w.z)};
    const double value = dot(normal_, w);
    const double error = relative_error * dot(permanent_, size) + underflow * (1 + size.x + size.y + size.z);
    return {value > error ? 1 : value < -error ? -1 : 0, value};
  }
  /// The projection along the axis along which the triangle has the largest area.
  Projection projection() const {
    const double x = std::abs(normal_.x), y = std::abs(normal_.y), z = std::abs(normal_.z);
    return projections[x > y && x > z ? 0 : y > z ? 1 : 2];
  }

  // Each of the six products of two differences is off by (1 + e)^3, e = 2^-53, their differences by (1 + e)^4; times
  // another difference (1 + e)^6, summed (1 + e)^8: 8 e of the permanent and terms in e^2; the computed permanent may
  // fall short by as many e^2. Allowed: 10 e.
  // mutant orient3d-no-error: `10 * 0x1p-53` -> `0`
  // mutant orient3d-error-less: `10` -> `1`
  static constexpr double relative_error = 10 * 0x1p-53;
  // Products that leave the normal range lose up to 2^-1075 each: 2^-1074 of each normal coordinate, times |w|, and
  // three more. Overflow makes the error infinite or NaN, so no sign is decided.
  // mutant orient3d-underflow: `0x1p-1000` -> `0`
  static constexpr double underflow = 0x1p-1000;

 private:
  Side exact_side(const Vec3& d, double value) const;

  const Triangle* t_;
  Vec3 normal_, permanent_;
};

}  // namespace morula::detail
