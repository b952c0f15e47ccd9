// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vectors of three components: Vec3 in double for numbers that are read, built or measured, Vec3f in float for numbers
// that change every frame.
#pragma once

// MSVC keeps __cplusplus at 199711 without /Zc:__cplusplus; _MSVC_LANG has its language version.
#if !(__cplusplus >= 202002L || (defined(_MSVC_LANG) && _MSVC_LANG >= 202002L))
#error "Morula needs C++20: -std=c++20, /std:c++20, or target_compile_features(... cxx_std_20)"
#endif

#include <algorithm>
#include <cmath>

namespace morula {

/// A point or a vector; all components are 0 by default. Operators work component by component and round to Scalar.
template <class Scalar>
struct Vector3 {
  Scalar x{}, y{}, z{};

  constexpr Vector3() = default;
  constexpr Vector3(Scalar x_, Scalar y_, Scalar z_) : x(x_), y(y_), z(z_) {}
  /// Converts between float and double. It is explicit, because a conversion to float rounds to the nearest number.
  template <class Other>
  constexpr explicit Vector3(const Vector3<Other>& v)
      : x(static_cast<Scalar>(v.x)), y(static_cast<Scalar>(v.y)), z(static_cast<Scalar>(v.z)) {}

  /// The component of an axis: 0 is x, 1 is y, any other number is z.
  constexpr Scalar& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr Scalar operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr bool operator==(const Vector3&) const = default;

  constexpr Vector3& operator+=(const Vector3& v) { return *this = *this + v; }
  constexpr Vector3& operator-=(const Vector3& v) { return *this = *this - v; }
  constexpr Vector3& operator*=(Scalar s) { return *this = *this * s; }

  friend constexpr Vector3 operator+(const Vector3& a, const Vector3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vector3 operator-(const Vector3& a, const Vector3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vector3 operator-(const Vector3& a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vector3 operator*(const Vector3& a, Scalar s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vector3 operator*(Scalar s, const Vector3& a) { return a * s; }
  friend constexpr Vector3 operator/(const Vector3& a, Scalar s) { return {a.x / s, a.y / s, a.z / s}; }
};

using Vec3 = Vector3<double>;
using Vec3f = Vector3<float>;
static_assert(sizeof(Vec3) == 24 && sizeof(Vec3f) == 12, "positions are read as packed arrays");

template <class Scalar>
constexpr Scalar dot(const Vector3<Scalar>& a, const Vector3<Scalar>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Scalar>
constexpr Vector3<Scalar> cross(const Vector3<Scalar>& a, const Vector3<Scalar>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Scalar>
constexpr Scalar squared_length(const Vector3<Scalar>& a) {
  return dot(a, a);
}
template <class Scalar>
Scalar length(const Vector3<Scalar>& a) {
  return std::sqrt(squared_length(a));
}
template <class Scalar>
constexpr Scalar squared_distance(const Vector3<Scalar>& a, const Vector3<Scalar>& b) {
  return squared_length(a - b);
}
template <class Scalar>
Scalar distance(const Vector3<Scalar>& a, const Vector3<Scalar>& b) {
  return length(a - b);
}
/// The unit vector along a; `fallback` if length(a) is computed as 0 or is not a number. In double that includes
/// vectors shorter than about 1e-162, whose squares vanish.
template <class Scalar>
Vector3<Scalar> normalized(const Vector3<Scalar>& a, const Vector3<Scalar>& fallback = {Scalar(1), 0, 0}) {
  const Scalar l = length(a);
  return l > 0 ? a / l : fallback;
}
template <class Scalar>
constexpr Vector3<Scalar> min(const Vector3<Scalar>& a, const Vector3<Scalar>& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
template <class Scalar>
constexpr Vector3<Scalar> max(const Vector3<Scalar>& a, const Vector3<Scalar>& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
template <class Scalar>
bool is_finite(const Vector3<Scalar>& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}
/// The largest of |x|, |y| and |z|.
template <class Scalar>
Scalar max_norm(const Vector3<Scalar>& a) {
  return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
}

}  // namespace morula
