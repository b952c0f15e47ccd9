// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/narrow.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace morula {

float narrow_plainly(const PositionView& positions, std::span<const std::uint32_t> vertices, const Vec3& origin,
                     LocalPoint* out) noexcept {
  float largest = 0;
  bool finite = true;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3f p(positions[vertices[i]] - origin);
    out[i] = {p.x, p.y, p.z, 0.0f};
    largest = std::max(largest, largest_component(p));
    finite = finite && is_finite(p);  // a maximum loses NaN
  }
  return finite ? largest : std::numeric_limits<float>::infinity();
}

#if defined(__SSE2__) && !defined(MORULA_SCALAR)

namespace {

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

template <class Scalar>
float narrow_as(const PositionView& view, std::span<const std::uint32_t> vertices, const Vec3& origin,
                LocalPoint* out) noexcept {
  const PositionView positions = view;  // a copy that stays in registers: writing points cannot change it
  const __m128d origin_xy = _mm_setr_pd(origin.x, origin.y), origin_z = _mm_set_sd(origin.z);
  __m128 lowest = _mm_setzero_ps(), highest = lowest, not_numbers = lowest;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const std::byte* p = positions.address(vertices[i]);
    const __m128 xy = _mm_cvtpd_ps(_mm_sub_pd(load_xy<Scalar>(p), origin_xy));
    const __m128 z = _mm_cvtpd_ps(_mm_sub_pd(load_z<Scalar>(p), origin_z));
    const __m128 point = _mm_movelh_ps(xy, z);
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

}  // namespace

float narrow(const PositionView& positions, std::span<const std::uint32_t> vertices, const Vec3& origin,
             LocalPoint* out) noexcept {
  return positions.is_double() ? narrow_as<double>(positions, vertices, origin, out)
                               : narrow_as<float>(positions, vertices, origin, out);
}

#else

float narrow(const PositionView& positions, std::span<const std::uint32_t> vertices, const Vec3& origin,
             LocalPoint* out) noexcept {
  return narrow_plainly(positions, vertices, origin, out);
}

#endif

}  // namespace morula
