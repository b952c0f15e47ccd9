// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/narrow.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "update/points/kernels.hpp"

namespace morula {
namespace {

#ifdef __GNUC__
[[gnu::noinline]]  // GCC 12 takes rounding to float and back for nothing where it does two coordinates at once
#endif
double
nearest_float(double x) {
  return static_cast<double>(static_cast<float>(x));
}

// Differences of floats, rounded to float, are the same whether taken in float or in double.
bool is_float(const Vec3& p) {
  return nearest_floats(p) == p;
}

// vertex(i): the one that goes to out[i].
template <class Vertex>
float narrow_each_plainly(const PositionView& positions, std::size_t count, const Vertex& vertex, const Vec3& origin,
                          LocalPoint* out) {
  float largest = 0;
  bool finite = true;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p(positions[vertex(i)] - origin);
    out[i] = {p.x, p.y, p.z, 0.0f};
    largest = std::max(largest, largest_component(p));
    finite = finite && is_finite(p);  // a maximum loses NaN
  }
  return finite ? largest : std::numeric_limits<float>::infinity();
}

#if defined(MORULA_SSE)

using Four = __m128;
void store(Four point, LocalPoint& out) {
  _mm_store_ps(&out.x, point);
}

template <class Scalar>
__m128d load_xy(const std::byte* p) {
  double two[2];
  std::memcpy(two, p, 2 * sizeof(Scalar));  // two floats fill the first
  if constexpr (sizeof(Scalar) == sizeof(double)) return _mm_loadu_pd(two);
  return _mm_cvtps_pd(_mm_castpd_ps(_mm_load_sd(two)));
}
template <class Scalar>
__m128d load_z(const std::byte* p) {
  Scalar z;
  std::memcpy(&z, p + 2 * sizeof(Scalar), sizeof z);
  return _mm_set_sd(static_cast<double>(z));
}

// Minus the origin, in double, then rounded.
template <class Scalar>
struct InDouble {
  __m128d origin_xy, origin_z;
  explicit InDouble(const Vec3& o) : origin_xy(_mm_setr_pd(o.x, o.y)), origin_z(_mm_set_sd(o.z)) {}
  Four operator()(const std::byte* p) const {
    const __m128 xy = _mm_cvtpd_ps(_mm_sub_pd(load_xy<Scalar>(p), origin_xy));
    return _mm_movelh_ps(xy, _mm_cvtpd_ps(_mm_sub_pd(load_z<Scalar>(p), origin_z)));
  }
};
struct InFloat {
  __m128 origin;
  explicit InFloat(const Vec3& o)
      : origin(_mm_setr_ps(static_cast<float>(o.x), static_cast<float>(o.y), static_cast<float>(o.z), 0.0f)) {}
  Four operator()(const std::byte* p) const {
    double xy;
    float z;
    std::memcpy(&xy, p, sizeof xy);
    std::memcpy(&z, p + sizeof xy, sizeof z);
    return _mm_sub_ps(_mm_movelh_ps(_mm_castpd_ps(_mm_set_sd(xy)), _mm_set_ss(z)), origin);
  }
};

// Of the coordinates seen so far.
class Largest {
 public:
  void add(Four point) {
    not_numbers_ = _mm_or_ps(not_numbers_, _mm_cmpunord_ps(point, point));  // minima and maxima lose NaN
    lowest_ = _mm_min_ps(point, lowest_);
    highest_ = _mm_max_ps(point, highest_);
  }
  bool is_number() const { return _mm_movemask_ps(not_numbers_) == 0; }
  void store(float* lanes) const { _mm_storeu_ps(lanes, _mm_max_ps(highest_, _mm_sub_ps(_mm_setzero_ps(), lowest_))); }

 private:
  __m128 lowest_ = _mm_setzero_ps(), highest_ = lowest_, not_numbers_ = lowest_;
};

#elif defined(MORULA_NEON)

using Four = float32x4_t;
void store(Four point, LocalPoint& out) {
  vst1q_f32(&out.x, point);
}

// x and y; z and 0.
template <class Scalar>
float64x2_t load_xy(const std::byte* p) {
  Scalar two[2];
  std::memcpy(two, p, sizeof two);
  if constexpr (sizeof(Scalar) == sizeof(double))
    return vld1q_f64(two);
  else
    return vcvt_f64_f32(vld1_f32(two));
}
template <class Scalar>
float64x2_t load_z(const std::byte* p) {
  Scalar z;
  std::memcpy(&z, p + 2 * sizeof(Scalar), sizeof z);
  return float64x2_t{static_cast<double>(z), 0.0};
}

// Minus the origin, in double, then rounded.
template <class Scalar>
struct InDouble {
  float64x2_t origin_xy, origin_z;
  explicit InDouble(const Vec3& o) : origin_xy{o.x, o.y}, origin_z{o.z, 0.0} {}
  Four operator()(const std::byte* p) const {
    const float32x2_t xy = vcvt_f32_f64(vsubq_f64(load_xy<Scalar>(p), origin_xy));
    return vcombine_f32(xy, vcvt_f32_f64(vsubq_f64(load_z<Scalar>(p), origin_z)));
  }
};
struct InFloat {
  float32x4_t origin;
  explicit InFloat(const Vec3& o)
      : origin{static_cast<float>(o.x), static_cast<float>(o.y), static_cast<float>(o.z), 0.0f} {}
  Four operator()(const std::byte* p) const {
    float coordinate[3];
    std::memcpy(coordinate, p, sizeof coordinate);
    const float32x2_t xy = vld1_f32(coordinate);
    return vsubq_f32(vcombine_f32(xy, float32x2_t{coordinate[2], 0.0f}), origin);
  }
};

// Of the coordinates seen so far.
class Largest {
 public:
  void add(Four point) {
    numbers_ = vandq_u32(numbers_, vceqq_f32(point, point));
    magnitude_ = vmaxq_f32(vabsq_f32(point), magnitude_);
  }
  bool is_number() const { return vminvq_u32(numbers_) != 0; }
  void store(float* lanes) const { vst1q_f32(lanes, magnitude_); }

 private:
  uint32x4_t numbers_ = vdupq_n_u32(~0u);
  float32x4_t magnitude_ = vdupq_n_f32(0.0f);
};

#endif

#if defined(MORULA_SSE) || defined(MORULA_NEON)

template <class Local, class Vertex>
float narrow_each_by(const PositionView& view, std::size_t count, const Vertex& vertex, const Vec3& origin,
                     LocalPoint* out) {
  const PositionView positions = view;  // a copy that stays in registers: writing points cannot change it
  const Local local(origin);
  Largest largest;
  for (std::size_t i = 0; i < count; ++i) {
    const Four point = local(positions.address(vertex(i)));
    store(point, out[i]);
    largest.add(point);
  }
  if (!largest.is_number()) return std::numeric_limits<float>::infinity();
  float lanes[4];
  largest.store(lanes);
  return std::max({lanes[0], lanes[1], lanes[2]});
}

template <class Vertex>
float narrow_each(const PositionView& positions, std::size_t count, const Vertex& vertex, const Vec3& origin,
                  LocalPoint* out) {
  if (positions.is_double()) return narrow_each_by<InDouble<double>>(positions, count, vertex, origin, out);
  if (is_float(origin)) return narrow_each_by<InFloat>(positions, count, vertex, origin, out);
  return narrow_each_by<InDouble<float>>(positions, count, vertex, origin, out);
}

#else

template <class Vertex>
float narrow_each(const PositionView& positions, std::size_t count, const Vertex& vertex, const Vec3& origin,
                  LocalPoint* out) {
  return narrow_each_plainly(positions, count, vertex, origin, out);
}

#endif

}  // namespace

Vec3 nearest_floats(const Vec3& p) noexcept {
  return {nearest_float(p.x), nearest_float(p.y), nearest_float(p.z)};
}

Vec3 origin_near(const Vec3& p, double size) noexcept {
  const Vec3 near = nearest_floats(p);
  return distance(near, p) <= 1e-3 * size ? near : p;
}

float narrow_plainly(const PositionView& positions, std::span<const std::uint32_t> vertices, const Vec3& origin,
                     LocalPoint* out) noexcept {
  return narrow_each_plainly(
      positions, vertices.size(), [&](std::size_t i) { return vertices[i]; }, origin, out);
}

float narrow(const PositionView& positions, std::span<const std::uint32_t> vertices, const Vec3& origin,
             LocalPoint* out) noexcept {
  return narrow_each(
      positions, vertices.size(), [&](std::size_t i) { return vertices[i]; }, origin, out);
}

float narrow_run(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                 LocalPoint* out) noexcept {
  if (!positions.is_packed_float() || !is_float(origin))
    return narrow_each(
        positions, count, [&](std::size_t i) { return first + i; }, origin, out);
  const std::uint32_t largest =
      kernels().narrow_floats(reinterpret_cast<const float*>(positions.address(first)), count, Vec3f(origin), out);
  constexpr std::uint32_t not_finite = 0x7f800000u;
  return largest < not_finite ? std::bit_cast<float>(largest) : std::numeric_limits<float>::infinity();
}

}  // namespace morula
