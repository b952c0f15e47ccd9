// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Four floats at once, for the loops that take the time: every point of every frame, every line of every fit. One type
// with vector instructions and its scalar twin: the same operations in the same order, so the same bits.
#pragma once

#include <array>
#include <cmath>
#include <morula/geometry/vector.hpp>
#if !defined(MORULA_SCALAR)
#if defined(__SSE2__)
#define MORULA_SSE 1
#include <emmintrin.h>
#elif defined(__aarch64__) && defined(__GNUC__)
#define MORULA_NEON 1
#include <arm_neon.h>
#endif
#endif

namespace morula {

/// A point about the frame's origin. Sixteen bytes, so that one load fetches it.
struct alignas(16) LocalPoint {
  float x = 0, y = 0, z = 0, unused = 0;
};
static_assert(sizeof(LocalPoint) == 16);

class ScalarFloat4 {
 public:
  ScalarFloat4() = default;
  explicit ScalarFloat4(float all) : lane_{all, all, all, all} {}
  explicit ScalarFloat4(const Vec3f& v) : lane_{v.x, v.y, v.z, 0.0f} {}
  static ScalarFloat4 counting() { return ScalarFloat4(0.0f, 1.0f, 2.0f, 3.0f); }
  static ScalarFloat4 load(const float* four) { return ScalarFloat4(four[0], four[1], four[2], four[3]); }
  static ScalarFloat4 load(const LocalPoint& p) { return ScalarFloat4(p.x, p.y, p.z, p.unused); }
  void store(LocalPoint& p) const { p = {lane_[0], lane_[1], lane_[2], lane_[3]}; }
  std::array<float, 4> lanes() const { return lane_; }

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
  /// The second where the two are equal or not comparable, as the instruction has it.
  friend ScalarFloat4 min(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s < t ? s : t; });
  }
  friend ScalarFloat4 max(const ScalarFloat4& a, const ScalarFloat4& b) {
    return a.with(b, [](float s, float t) { return s > t ? s : t; });
  }
  friend ScalarFloat4 sqrt(const ScalarFloat4& a) {
    return a.with(a, [](float s, float) { return std::sqrt(s); });
  }
  /// Rounded towards zero, as numbers and as floats. Lanes must fit an int.
  ScalarFloat4 truncated(std::array<int, 4>& whole) const {
    ScalarFloat4 result;
    for (std::size_t k = 0; k < 4; ++k)
      whole[k] = static_cast<int>(lane_[k]), result.lane_[k] = static_cast<float>(whole[k]);
    return result;
  }
  /// Rows become columns.
  static void transpose(ScalarFloat4& a, ScalarFloat4& b, ScalarFloat4& c, ScalarFloat4& d) {
    const ScalarFloat4 rows[4]{a, b, c, d};
    for (int k = 0; k < 4; ++k) {
      a.lane_[k] = rows[k].lane_[0], b.lane_[k] = rows[k].lane_[1];
      c.lane_[k] = rows[k].lane_[2], d.lane_[k] = rows[k].lane_[3];
    }
  }
  /// Four points become their x, their y and their z.
  static void transpose_points(ScalarFloat4& a, ScalarFloat4& b, ScalarFloat4& c, const ScalarFloat4& d) {
    const ScalarFloat4 rows[4]{a, b, c, d};
    for (int k = 0; k < 4; ++k)
      a.lane_[k] = rows[k].lane_[0], b.lane_[k] = rows[k].lane_[1], c.lane_[k] = rows[k].lane_[2];
  }

 private:
  ScalarFloat4(float a, float b, float c, float d) : lane_{a, b, c, d} {}
  template <class Operation>
  ScalarFloat4 with(const ScalarFloat4& other, const Operation& operation) const {
    ScalarFloat4 result;
    for (int k = 0; k < 4; ++k) result.lane_[k] = operation(lane_[k], other.lane_[k]);
    return result;
  }
  std::array<float, 4> lane_;
};

#if defined(MORULA_SSE)

class SseFloat4 {
 public:
  SseFloat4() = default;
  explicit SseFloat4(float all) : v_(_mm_set1_ps(all)) {}
  explicit SseFloat4(const Vec3f& v) : v_(_mm_setr_ps(v.x, v.y, v.z, 0.0f)) {}
  static SseFloat4 counting() { return SseFloat4(_mm_setr_ps(0.0f, 1.0f, 2.0f, 3.0f)); }
  static SseFloat4 load(const float* four) { return SseFloat4(_mm_loadu_ps(four)); }
  static SseFloat4 load(const LocalPoint& p) { return SseFloat4(_mm_load_ps(&p.x)); }
  void store(LocalPoint& p) const { _mm_store_ps(&p.x, v_); }
  std::array<float, 4> lanes() const {
    std::array<float, 4> four;
    _mm_storeu_ps(four.data(), v_);
    return four;
  }

  friend SseFloat4 operator+(SseFloat4 a, SseFloat4 b) { return SseFloat4(_mm_add_ps(a.v_, b.v_)); }
  friend SseFloat4 operator-(SseFloat4 a, SseFloat4 b) { return SseFloat4(_mm_sub_ps(a.v_, b.v_)); }
  friend SseFloat4 operator*(SseFloat4 a, SseFloat4 b) { return SseFloat4(_mm_mul_ps(a.v_, b.v_)); }
  friend SseFloat4 operator/(SseFloat4 a, SseFloat4 b) { return SseFloat4(_mm_div_ps(a.v_, b.v_)); }
  friend SseFloat4 min(SseFloat4 a, SseFloat4 b) { return SseFloat4(_mm_min_ps(a.v_, b.v_)); }
  friend SseFloat4 max(SseFloat4 a, SseFloat4 b) { return SseFloat4(_mm_max_ps(a.v_, b.v_)); }
  friend SseFloat4 sqrt(SseFloat4 a) { return SseFloat4(_mm_sqrt_ps(a.v_)); }
  SseFloat4 truncated(std::array<int, 4>& whole) const {
    const __m128i integers = _mm_cvttps_epi32(v_);
    _mm_storeu_si128(reinterpret_cast<__m128i*>(whole.data()), integers);
    return SseFloat4(_mm_cvtepi32_ps(integers));
  }
  static void transpose(SseFloat4& a, SseFloat4& b, SseFloat4& c, SseFloat4& d) {
    _MM_TRANSPOSE4_PS(a.v_, b.v_, c.v_, d.v_);
  }
  static void transpose_points(SseFloat4& a, SseFloat4& b, SseFloat4& c, SseFloat4 d) {
    const __m128 xy_ab = _mm_unpacklo_ps(a.v_, b.v_), xy_cd = _mm_unpacklo_ps(c.v_, d.v_);
    const __m128 z_ab = _mm_unpackhi_ps(a.v_, b.v_), z_cd = _mm_unpackhi_ps(c.v_, d.v_);
    a.v_ = _mm_movelh_ps(xy_ab, xy_cd);
    b.v_ = _mm_movehl_ps(xy_cd, xy_ab);
    c.v_ = _mm_movelh_ps(z_ab, z_cd);
  }

 private:
  explicit SseFloat4(__m128 v) : v_(v) {}
  __m128 v_;
};
using Float4 = SseFloat4;

#elif defined(MORULA_NEON)

class NeonFloat4 {
 public:
  NeonFloat4() = default;
  explicit NeonFloat4(float all) : v_(vdupq_n_f32(all)) {}
  explicit NeonFloat4(const Vec3f& v) : v_{v.x, v.y, v.z, 0.0f} {}
  static NeonFloat4 counting() { return NeonFloat4(float32x4_t{0.0f, 1.0f, 2.0f, 3.0f}); }
  static NeonFloat4 load(const float* four) { return NeonFloat4(vld1q_f32(four)); }
  static NeonFloat4 load(const LocalPoint& p) { return NeonFloat4(vld1q_f32(&p.x)); }
  void store(LocalPoint& p) const { vst1q_f32(&p.x, v_); }
  std::array<float, 4> lanes() const {
    std::array<float, 4> four;
    vst1q_f32(four.data(), v_);
    return four;
  }

  friend NeonFloat4 operator+(NeonFloat4 a, NeonFloat4 b) { return NeonFloat4(vaddq_f32(a.v_, b.v_)); }
  friend NeonFloat4 operator-(NeonFloat4 a, NeonFloat4 b) { return NeonFloat4(vsubq_f32(a.v_, b.v_)); }
  friend NeonFloat4 operator*(NeonFloat4 a, NeonFloat4 b) { return NeonFloat4(vmulq_f32(a.v_, b.v_)); }
  friend NeonFloat4 operator/(NeonFloat4 a, NeonFloat4 b) { return NeonFloat4(vdivq_f32(a.v_, b.v_)); }
  // Its own minima and maxima have other ideas of NaN and of zeros' signs.
  friend NeonFloat4 min(NeonFloat4 a, NeonFloat4 b) { return NeonFloat4(vbslq_f32(vcltq_f32(a.v_, b.v_), a.v_, b.v_)); }
  friend NeonFloat4 max(NeonFloat4 a, NeonFloat4 b) { return NeonFloat4(vbslq_f32(vcgtq_f32(a.v_, b.v_), a.v_, b.v_)); }
  friend NeonFloat4 sqrt(NeonFloat4 a) { return NeonFloat4(vsqrtq_f32(a.v_)); }
  NeonFloat4 truncated(std::array<int, 4>& whole) const {
    const int32x4_t integers = vcvtq_s32_f32(v_);
    vst1q_s32(whole.data(), integers);
    return NeonFloat4(vcvtq_f32_s32(integers));
  }
  static void transpose(NeonFloat4& a, NeonFloat4& b, NeonFloat4& c, NeonFloat4& d) {
    const float32x4_t xy_ac = vzip1q_f32(a.v_, c.v_), xy_bd = vzip1q_f32(b.v_, d.v_);
    const float32x4_t zw_ac = vzip2q_f32(a.v_, c.v_), zw_bd = vzip2q_f32(b.v_, d.v_);
    a.v_ = vzip1q_f32(xy_ac, xy_bd), b.v_ = vzip2q_f32(xy_ac, xy_bd);
    c.v_ = vzip1q_f32(zw_ac, zw_bd), d.v_ = vzip2q_f32(zw_ac, zw_bd);
  }
  static void transpose_points(NeonFloat4& a, NeonFloat4& b, NeonFloat4& c, NeonFloat4 d) { transpose(a, b, c, d); }

 private:
  explicit NeonFloat4(float32x4_t v) : v_(v) {}
  float32x4_t v_;
};
using Float4 = NeonFloat4;

#else
using Float4 = ScalarFloat4;
#endif

/// Largest of the four.
template <class Wide>
float largest_lane(const Wide& wide) {
  const std::array<float, 4> lane = wide.lanes();
  const float a = lane[0] > lane[1] ? lane[0] : lane[1], b = lane[2] > lane[3] ? lane[2] : lane[3];
  return a > b ? a : b;
}

}  // namespace morula
