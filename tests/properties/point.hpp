// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The oracle's own arithmetic: what is judged comes in as plain numbers, and nothing of the library is included here.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace oracle {

/// 64 bits of mantissa on x86, 113 elsewhere: errors of the judge are a thousand times below those of double.
using Real = long double;
inline constexpr Real epsilon = std::numeric_limits<Real>::epsilon();

template <class T>
struct Vector {
  T x{}, y{}, z{};

  friend Vector operator+(const Vector& a, const Vector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vector operator-(const Vector& a, const Vector& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vector operator*(T s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
  friend T dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  friend Vector cross(const Vector& a, const Vector& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
};

using Point = Vector<Real>;
using Triangle = std::array<Point, 3>;

struct Ball {
  Point center;
  Real radius = 0;
};

inline Real distance(const Point& a, const Point& b) {
  return std::sqrt(dot(a - b, a - b));
}
inline Real largest_coordinate(const Point& p) {
  return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
}

}  // namespace oracle
