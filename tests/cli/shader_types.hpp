// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The types and functions of GLSL and WGSL that the evaluators of skin bounds use, in float, so that their texts
// compile as C++. Nothing here converts to double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace morula::test::shader {

using u32 = std::uint32_t;
using f32 = float;
using uint = std::uint32_t;

struct vec4;
struct vec3 {
  float x, y, z;
  vec3() : x(0), y(0), z(0) {}
  explicit vec3(float a) : x(a), y(a), z(a) {}
  vec3(float a, float b, float c) : x(a), y(b), z(c) {}
  explicit vec3(const vec4& v);
};
struct vec4 {
  float x, y, z, w;
  vec4() : x(0), y(0), z(0), w(0) {}
  explicit vec4(float a) : x(a), y(a), z(a), w(a) {}
  vec4(float a, float b, float c, float d) : x(a), y(b), z(c), w(d) {}
  vec4(const vec3& v, float d) : x(v.x), y(v.y), z(v.z), w(d) {}
  vec3 xyz() const { return {x, y, z}; }
};
inline vec3::vec3(const vec4& v) : x(v.x), y(v.y), z(v.z) {}

inline vec3 operator+(const vec3& a, const vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vec3 operator-(const vec3& a, const vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vec3 operator*(const vec3& a, const vec3& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline vec3 operator*(float s, const vec3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline vec3 operator*(const vec3& a, float s) {
  return s * a;
}
inline vec3& operator+=(vec3& a, const vec3& b) {
  return a = a + b;
}
inline vec3& operator-=(vec3& a, const vec3& b) {
  return a = a - b;
}
inline vec4 operator+(const vec4& a, const vec4& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w};
}
inline vec4 operator-(const vec4& a, const vec4& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w};
}
inline vec4 operator*(float s, const vec4& a) {
  return {s * a.x, s * a.y, s * a.z, s * a.w};
}
inline vec4 operator*(const vec4& a, float s) {
  return s * a;
}
inline vec4& operator+=(vec4& a, const vec4& b) {
  return a = a + b;
}

/// Four columns, as in both languages.
struct mat4 {
  vec4 columns[4];
  mat4() = default;
  mat4(const vec4& a, const vec4& b, const vec4& c, const vec4& d) : columns{a, b, c, d} {}
  const vec4& operator[](std::size_t i) const { return columns[i]; }
  vec4& operator[](std::size_t i) { return columns[i]; }
};
inline vec4 operator*(const mat4& m, const vec4& v) {
  return v.x * m[0] + v.y * m[1] + v.z * m[2] + v.w * m[3];
}
inline mat4 operator*(float s, const mat4& m) {
  return {s * m[0], s * m[1], s * m[2], s * m[3]};
}
inline mat4 operator*(const mat4& m, float s) {
  return s * m;
}
inline mat4 operator+(const mat4& a, const mat4& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]};
}
inline mat4 operator-(const mat4& a, const mat4& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]};
}
inline mat4& operator+=(mat4& a, const mat4& b) {
  return a = a + b;
}

inline float dot(const vec3& a, const vec3& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float dot(const vec4& a, const vec4& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}
inline float length(const vec3& a) {
  return std::sqrt(dot(a, a));
}
inline float distance(const vec3& a, const vec3& b) {
  return length(a - b);
}
inline float sqrt(float a) {
  return std::sqrt(a);
}
inline vec3 sqrt(const vec3& a) {
  return {std::sqrt(a.x), std::sqrt(a.y), std::sqrt(a.z)};
}
inline float abs(float a) {
  return std::fabs(a);
}
inline vec3 abs(const vec3& a) {
  return {std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)};
}
inline float max(float a, float b) {
  return std::max(a, b);
}
inline float min(float a, float b) {
  return std::min(a, b);
}
inline vec3 max(const vec3& a, const vec3& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
inline vec3 min(const vec3& a, const vec3& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}

// WGSL's names.
using vec3f = vec3;
using vec4f = vec4;
using mat4x4f = mat4;

/// The constructor of a structure of three members, which C++ writes with braces.
template <class Result>
Result made(Result result, const vec4& sphere, const vec3& lower, const vec3& upper) {
  result.sphere = sphere;
  result.lower = lower;
  result.upper = upper;
  return result;
}

}  // namespace morula::test::shader
