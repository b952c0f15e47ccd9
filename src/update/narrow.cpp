// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/narrow.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "update/kernels.hpp"

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

#if defined(__SSE2__) && !defined(MORULA_SCALAR)

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
  __m128 operator()(const std::byte* p) const {
    const __m128 xy = _mm_cvtpd_ps(_mm_sub_pd(load_xy<Scalar>(p), origin_xy));
    return _mm_movelh_ps(xy, _mm_cvtpd_ps(_mm_sub_pd(load_z<Scalar>(p), origin_z)));
  }
};
struct InFloat {
  __m128 origin;
  explicit InFloat(const Vec3& o)
      : origin(_mm_setr_ps(static_cast<float>(o.x), static_cast<float>(o.y), static_cast<float>(o.z), 0.0f)) {}
  __m128 operator()(const std::byte* p) const {
    double xy;
    float z;
    std::memcpy(&xy, p, sizeof xy);
    std::memcpy(&z, p + sizeof xy, sizeof z);
    return _mm_sub_ps(_mm_movelh_ps(_mm_castpd_ps(_mm_set_sd(xy)), _mm_set_ss(z)), origin);
  }
};

template <class Local, class Vertex>
float narrow_each_by(const PositionView& view, std::size_t count, const Vertex& vertex, const Vec3& origin,
                     LocalPoint* out) {
  const PositionView positions = view;  // a copy that stays in registers: writing points cannot change it
  const Local local(origin);
  __m128 lowest = _mm_setzero_ps(), highest = lowest, not_numbers = lowest;
  for (std::size_t i = 0; i < count; ++i) {
    const __m128 point = local(positions.address(vertex(i)));
    _mm_store_ps(&out[i].x, point);
    not_numbers = _mm_or_ps(not_numbers, _mm_cmpunord_ps(point, point));  // minima and maxima lose NaN
    lowest = _mm_min_ps(point, lowest);
    highest = _mm_max_ps(point, highest);
  }
  if (_mm_movemask_ps(not_numbers) != 0) return std::numeric_limits<float>::infinity();
  alignas(16) float lanes[4];
  _mm_store_ps(lanes, _mm_max_ps(highest, _mm_sub_ps(_mm_setzero_ps(), lowest)));
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
