// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Four floats, or two doubles, in one register: for code of fixed width, which every processor runs in the same way.
// Each type has a scalar twin that does the same operations in the same order, hence with the same bits; it replaces
// the type if the compiler has no vector types. Loops that gain from wider registers are kernels: every_processor.inl,
// wide.inl.
//
// Minima and maxima are the second where the two are equal or not comparable, like the instructions of x86. NEON's own
// instructions differ for NaN and for signs of zeros.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>

#include "simd/instructions.hpp"

namespace morula::detail {

/// A type with three coordinates in float: a vector of the library, which is in a layer above this folder.
template <class Vector>
concept HasThreeFloats = requires(const Vector& v) {
  { v.x } -> std::convertible_to<const float&>;
  { v.y } -> std::convertible_to<const float&>;
  { v.z } -> std::convertible_to<const float&>;
};

/// A point about the frame's origin. Sixteen bytes, so that one load fetches it.
struct alignas(16) LocalPoint {
  float x = 0, y = 0, z = 0, unused = 0;
};
static_assert(sizeof(LocalPoint) == 16);

class ScalarDouble2 {
 public:
  ScalarDouble2() = default;
  explicit ScalarDouble2(double all) : lane_{all, all} {}
  ScalarDouble2(double a, double b) : lane_{a, b} {}
  static ScalarDouble2 load(const double* two) { return {two[0], two[1]}; }
  /// Two numbers of a type, widened, of any alignment.
  template <class Number>
  static ScalarDouble2 read(const std::byte* two) {
    Number lane[2];
    std::memcpy(lane, two, sizeof lane);
    return {static_cast<double>(lane[0]), static_cast<double>(lane[1])};
  }
  void store(double* two) const { two[0] = lane_[0], two[1] = lane_[1]; }
  double operator[](int lane) const { return lane_[static_cast<std::size_t>(lane)]; }

  ScalarDouble2 operator-() const { return {-lane_[0], -lane_[1]}; }
  friend ScalarDouble2 operator+(const ScalarDouble2& a, const ScalarDouble2& b) { return {a[0] + b[0], a[1] + b[1]}; }
  friend ScalarDouble2 operator-(const ScalarDouble2& a, const ScalarDouble2& b) { return {a[0] - b[0], a[1] - b[1]}; }
  friend ScalarDouble2 operator*(const ScalarDouble2& a, const ScalarDouble2& b) { return {a[0] * b[0], a[1] * b[1]}; }
  friend ScalarDouble2 min(const ScalarDouble2& a, const ScalarDouble2& b) {
    return {a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]};
  }
  friend ScalarDouble2 max(const ScalarDouble2& a, const ScalarDouble2& b) {
    return {a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]};
  }

 private:
  std::array<double, 2> lane_;
};

class ScalarFloat4 {
 public:
  ScalarFloat4() = default;
  explicit ScalarFloat4(float all) : lane_{all, all, all, all} {}
  explicit ScalarFloat4(const HasThreeFloats auto& v) : lane_{v.x, v.y, v.z, 0.0f} {}
  ScalarFloat4(float a, float b, float c, float d) : lane_{a, b, c, d} {}
  static ScalarFloat4 counting() { return {0.0f, 1.0f, 2.0f, 3.0f}; }
  static ScalarFloat4 load(const float* four) { return {four[0], four[1], four[2], four[3]}; }
  static ScalarFloat4 load(const LocalPoint& p) { return {p.x, p.y, p.z, p.unused}; }
  /// Three floats of any alignment, and 0.
  static ScalarFloat4 read_three(const std::byte* three) {
    float lane[3];
    std::memcpy(lane, three, sizeof lane);
    return {lane[0], lane[1], lane[2], 0.0f};
  }
  /// The lanes of a, then those of b, each rounded to the nearest float.
  static ScalarFloat4 rounded(const ScalarDouble2& a, const ScalarDouble2& b) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(b[0]), static_cast<float>(b[1])};
  }
  void store(LocalPoint& p) const { p = {lane_[0], lane_[1], lane_[2], lane_[3]}; }
  void store(float* four) const { std::memcpy(four, lane_.data(), sizeof lane_); }
  std::array<float, 4> lanes() const { return lane_; }
  float operator[](int lane) const { return lane_[static_cast<std::size_t>(lane)]; }

  ScalarFloat4 operator-() const { return {-lane_[0], -lane_[1], -lane_[2], -lane_[3]}; }
  friend ScalarFloat4 operator+(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s + t; });
  }
  friend ScalarFloat4 operator-(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s - t; });
  }
  friend ScalarFloat4 operator*(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s * t; });
  }
  friend ScalarFloat4 operator/(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s / t; });
  }
  friend ScalarFloat4 min(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s < t ? s : t; });
  }
  friend ScalarFloat4 max(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s > t ? s : t; });
  }
  friend ScalarFloat4 sqrt(const ScalarFloat4& a) {
    return a.with(a, [](float s, float) { return std::sqrt(s); });
  }
  /// Sets all bits of lanes that are NaN, and none of the others.
  friend ScalarFloat4 not_numbers(const ScalarFloat4& a) {
    return a.with(a, [](float s, float) { return std::bit_cast<float>(s == s ? 0u : ~0u); });
  }
  friend ScalarFloat4 operator|(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) {
      return std::bit_cast<float>(std::bit_cast<std::uint32_t>(s) | std::bit_cast<std::uint32_t>(t));
    });
  }
  /// Rounds towards zero, to integers and to floats. Lanes must fit an int.
  ScalarFloat4 truncated(std::array<int, 4>& whole) const {
    ScalarFloat4 result;
    for (std::size_t k = 0; k < 4; ++k)
      whole[k] = static_cast<int>(lane_[k]), result.lane_[k] = static_cast<float>(whole[k]);
    return result;
  }
  /// Transposes: rows become columns.
  static void transpose(ScalarFloat4& a, ScalarFloat4& b, ScalarFloat4& c, ScalarFloat4& d) {
    const ScalarFloat4 rows[4]{a, b, c, d};
    for (std::size_t k = 0; k < 4; ++k) {
      a.lane_[k] = rows[k].lane_[0], b.lane_[k] = rows[k].lane_[1];
      c.lane_[k] = rows[k].lane_[2], d.lane_[k] = rows[k].lane_[3];
    }
  }
  /// Transposes four points into their x, y and z.
  static void transpose_points(ScalarFloat4& a, ScalarFloat4& b, ScalarFloat4& c, ScalarFloat4 d) {
    transpose(a, b, c, d);
  }

 private:
  template <class Operation>
  ScalarFloat4 with(const ScalarFloat4& other, const Operation& operation) const {
    ScalarFloat4 result;
    for (std::size_t k = 0; k < 4; ++k) result.lane_[k] = operation(lane_[k], other.lane_[k]);
    return result;
  }
  std::array<float, 4> lane_;
};

#ifdef MORULA_VECTORS

class VectorDouble2 {
 public:
  typedef double Register __attribute__((vector_size(16)));

  VectorDouble2() = default;
  explicit VectorDouble2(double all) : v_{all, all} {}
  explicit VectorDouble2(Register v) : v_(v) {}
  VectorDouble2(double a, double b) : v_{a, b} {}
  static VectorDouble2 load(const double* two) {
    Register v;
    std::memcpy(&v, two, sizeof v);
    return VectorDouble2(v);
  }
  template <class Number>
  static VectorDouble2 read(const std::byte* two) {
    if constexpr (sizeof(Number) == sizeof(double)) {
      Register v;
      std::memcpy(&v, two, sizeof v);
      return VectorDouble2(v);
    }
#if defined(__x86_64__)
    double both;  // two floats fill it
    std::memcpy(&both, two, sizeof both);
    return VectorDouble2(_mm_cvtps_pd(_mm_castpd_ps(_mm_set_sd(both))));
#elif defined(__wasm_simd128__)
    return VectorDouble2(std::bit_cast<Register>(wasm_f64x2_promote_low_f32x4(wasm_v128_load64_zero(two))));
#else
    Number lane[2];
    std::memcpy(lane, two, sizeof lane);
    return {static_cast<double>(lane[0]), static_cast<double>(lane[1])};
#endif
  }
  void store(double* two) const {
    std::memcpy(two, &v_, sizeof v_);
  }
  double operator[](int lane) const {
    return v_[lane];
  }
  Register lanes() const {
    return v_;
  }

  VectorDouble2 operator-() const {
    return VectorDouble2(-v_);
  }
  friend VectorDouble2 operator+(VectorDouble2 a, VectorDouble2 b) {
    return VectorDouble2(a.v_ + b.v_);
  }
  friend VectorDouble2 operator-(VectorDouble2 a, VectorDouble2 b) {
    return VectorDouble2(a.v_ - b.v_);
  }
  friend VectorDouble2 operator*(VectorDouble2 a, VectorDouble2 b) {
    return VectorDouble2(a.v_ * b.v_);
  }
  friend VectorDouble2 min(VectorDouble2 a, VectorDouble2 b) {
    return VectorDouble2(a.v_ < b.v_ ? a.v_ : b.v_);
  }
  friend VectorDouble2 max(VectorDouble2 a, VectorDouble2 b) {
    return VectorDouble2(a.v_ > b.v_ ? a.v_ : b.v_);
  }

 private:
  Register v_;
};

class VectorFloat4 {
 public:
  typedef float Register __attribute__((vector_size(16)));

  VectorFloat4() = default;
  explicit VectorFloat4(float all) : v_{all, all, all, all} {}
  explicit VectorFloat4(const HasThreeFloats auto& v) : v_{v.x, v.y, v.z, 0.0f} {}
  explicit VectorFloat4(Register v) : v_(v) {}
  VectorFloat4(float a, float b, float c, float d) : v_{a, b, c, d} {}
  static VectorFloat4 counting() { return {0.0f, 1.0f, 2.0f, 3.0f}; }
  static VectorFloat4 load(const float* four) {
    Register v;
    std::memcpy(&v, four, sizeof v);
    return VectorFloat4(v);
  }
  static VectorFloat4 load(const LocalPoint& p) { return VectorFloat4(*reinterpret_cast<const Aligned*>(&p)); }
  static VectorFloat4 read_three(const std::byte* three) {
    float z;
    std::memcpy(&z, three + 8, sizeof z);
#if defined(__x86_64__)
    double xy;  // two floats fill it
    std::memcpy(&xy, three, sizeof xy);
    return VectorFloat4(_mm_movelh_ps(_mm_castpd_ps(_mm_set_sd(xy)), _mm_set_ss(z)));
#else
    float xy[2];
    std::memcpy(xy, three, sizeof xy);
    return {xy[0], xy[1], z, 0.0f};
#endif
  }
  static VectorFloat4 rounded(VectorDouble2 a, VectorDouble2 b) {
#if defined(__x86_64__)
    return VectorFloat4(_mm_movelh_ps(_mm_cvtpd_ps(a.lanes()), _mm_cvtpd_ps(b.lanes())));
#elif defined(__aarch64__)
    return VectorFloat4(vcvt_high_f32_f64(vcvt_f32_f64(a.lanes()), b.lanes()));
#elif defined(__wasm_simd128__)
    const v128_t low = wasm_f32x4_demote_f64x2_zero(std::bit_cast<v128_t>(a.lanes()));
    const v128_t high = wasm_f32x4_demote_f64x2_zero(std::bit_cast<v128_t>(b.lanes()));
    return VectorFloat4(std::bit_cast<Register>(wasm_i64x2_shuffle(low, high, 0, 2)));
#else
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(b[0]), static_cast<float>(b[1])};
#endif
  }
  void store(LocalPoint& p) const {
    *reinterpret_cast<Aligned*>(&p) = v_;
  }
  void store(float* four) const {
    std::memcpy(four, &v_, sizeof v_);
  }
  std::array<float, 4> lanes() const {
    return std::bit_cast<std::array<float, 4>>(v_);
  }
  float operator[](int lane) const {
    return v_[lane];
  }

  VectorFloat4 operator-() const {
    return VectorFloat4(-v_);
  }
  friend VectorFloat4 operator+(VectorFloat4 a, VectorFloat4 b) {
    return VectorFloat4(a.v_ + b.v_);
  }
  friend VectorFloat4 operator-(VectorFloat4 a, VectorFloat4 b) {
    return VectorFloat4(a.v_ - b.v_);
  }
  friend VectorFloat4 operator*(VectorFloat4 a, VectorFloat4 b) {
    return VectorFloat4(a.v_ * b.v_);
  }
  friend VectorFloat4 operator/(VectorFloat4 a, VectorFloat4 b) {
    return VectorFloat4(a.v_ / b.v_);
  }
  friend VectorFloat4 min(VectorFloat4 a, VectorFloat4 b) {
#if defined(__x86_64__)
    return VectorFloat4(_mm_min_ps(a.v_, b.v_));
#else
    return VectorFloat4(a.v_ < b.v_ ? a.v_ : b.v_);
#endif
  }
  friend VectorFloat4 max(VectorFloat4 a, VectorFloat4 b) {
#if defined(__x86_64__)
    return VectorFloat4(_mm_max_ps(a.v_, b.v_));
#else
    return VectorFloat4(a.v_ > b.v_ ? a.v_ : b.v_);
#endif
  }
  friend VectorFloat4 sqrt(VectorFloat4 a) {
#if defined(__x86_64__)
    return VectorFloat4(_mm_sqrt_ps(a.v_));
#elif defined(__aarch64__)
    return VectorFloat4(vsqrtq_f32(a.v_));
#elif defined(__wasm_simd128__)
    return VectorFloat4(std::bit_cast<Register>(wasm_f32x4_sqrt(std::bit_cast<v128_t>(a.v_))));
#else
    return {std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
#endif
  }
  friend VectorFloat4 not_numbers(VectorFloat4 a) {
    return of_bits(a.v_ != a.v_);
  }
  friend VectorFloat4 operator|(VectorFloat4 a, VectorFloat4 b) {
    return of_bits(bits(a.v_) | bits(b.v_));
  }
  VectorFloat4 truncated(std::array<int, 4>& whole) const {
    const Integers integers = __builtin_convertvector(v_, Integers);
    std::memcpy(whole.data(), &integers, sizeof integers);
    return VectorFloat4(__builtin_convertvector(integers, Register));
  }
  static void transpose(VectorFloat4& a, VectorFloat4& b, VectorFloat4& c, VectorFloat4& d) {
    const Register xy_ab = __builtin_shufflevector(a.v_, b.v_, 0, 4, 1, 5);
    const Register xy_cd = __builtin_shufflevector(c.v_, d.v_, 0, 4, 1, 5);
    const Register zw_ab = __builtin_shufflevector(a.v_, b.v_, 2, 6, 3, 7);
    const Register zw_cd = __builtin_shufflevector(c.v_, d.v_, 2, 6, 3, 7);
    a.v_ = __builtin_shufflevector(xy_ab, xy_cd, 0, 1, 4, 5);
    b.v_ = __builtin_shufflevector(xy_ab, xy_cd, 2, 3, 6, 7);
    c.v_ = __builtin_shufflevector(zw_ab, zw_cd, 0, 1, 4, 5);
    d.v_ = __builtin_shufflevector(zw_ab, zw_cd, 2, 3, 6, 7);
  }
  static void transpose_points(VectorFloat4& a, VectorFloat4& b, VectorFloat4& c, VectorFloat4 d) {
    transpose(a, b, c, d);
  }

 private:
  typedef float Aligned __attribute__((vector_size(16), may_alias));
  typedef std::int32_t Integers __attribute__((vector_size(16)));
  static Integers bits(Register v) {
    return std::bit_cast<Integers>(v);
  }
  static VectorFloat4 of_bits(Integers bits) {
    return VectorFloat4(std::bit_cast<Register>(bits));
  }
  Register v_;
};

using Double2 = VectorDouble2;
using Float4 = VectorFloat4;

#else

using Double2 = ScalarDouble2;
using Float4 = ScalarFloat4;

#endif

/// Largest of the four.
template <class Four>
float largest_lane(const Four& four) {
  const std::array<float, 4> lane = four.lanes();
  const float a = lane[0] > lane[1] ? lane[0] : lane[1], b = lane[2] > lane[3] ? lane[2] : lane[3];
  return a > b ? a : b;
}

}  // namespace morula::detail
