// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/narrow.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "update/points/kernels.hpp"

namespace morula::detail {
namespace {

#ifdef __GNUC__
[[gnu::noinline]]  // GCC 12 removes rounding to float and back in code that does two coordinates at once
#endif
double
nearest_float(double x) {
  return static_cast<double>(static_cast<float>(x));
}

// Differences of floats, rounded to float, are the same whether taken in float or in double.
bool is_float(const Vec3& p) {
  return nearest_floats(p) == p;
}

// Two coordinates and one: minus the origin in double, then rounded.
template <class Scalar>
class InDouble {
 public:
  explicit InDouble(const Vec3& o) : origin_xy_(o.x, o.y), origin_z_(o.z, 0.0) {}
  Float4 operator()(const std::byte* p) const {
    Scalar z;
    std::memcpy(&z, p + 2 * sizeof z, sizeof z);
    return Float4::rounded(Double2::read<Scalar>(p) - origin_xy_, Double2(static_cast<double>(z), 0.0) - origin_z_);
  }

 private:
  Double2 origin_xy_, origin_z_;
};
class InFloat {
 public:
  explicit InFloat(const Vec3& o) : origin_(Vec3f(o)) {}
  Float4 operator()(const std::byte* p) const { return Float4::read_three(p) - origin_; }

 private:
  Float4 origin_;
};

// place(i): index of the i-th point in the output.
template <class Local, class Place>
float narrow_by(const PositionView& view, std::size_t first, std::size_t count, const Vec3& origin, LocalPoint* out,
                const Place& place) {
  const PositionView positions = view;  // a copy that stays in registers: writing points cannot change it
  const Local local(origin);
  Float4 lowest(0.0f), highest(0.0f), not_a_number(0.0f);
  for (std::size_t i = 0; i < count; ++i) {
    const Float4 point = local(positions.address(first + i));
    point.store(out[place(i)]);
    not_a_number = not_a_number | not_numbers(point);  // minima and maxima lose NaN
    lowest = min(point, lowest);
    highest = max(point, highest);
  }
  for (const float lane : not_a_number.lanes())
    if (std::bit_cast<std::uint32_t>(lane) != 0) return std::numeric_limits<float>::infinity();
  return largest_lane(max(highest, Float4(0.0f) - lowest));
}

template <class Place>
float narrow_each(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                  LocalPoint* out, const Place& place) {
  if (positions.is_double()) return narrow_by<InDouble<double>>(positions, first, count, origin, out, place);
  if (is_float(origin)) return narrow_by<InFloat>(positions, first, count, origin, out, place);
  return narrow_by<InDouble<float>>(positions, first, count, origin, out, place);
}

// The largest |coordinate| from its bit pattern.
float largest_of(std::uint32_t bits) {
  constexpr std::uint32_t not_finite = 0x7f800000u;
  return bits < not_finite ? std::bit_cast<float>(bits) : std::numeric_limits<float>::infinity();
}

}  // namespace

Vec3 nearest_floats(const Vec3& p) noexcept {
  return {nearest_float(p.x), nearest_float(p.y), nearest_float(p.z)};
}

Vec3 origin_near(const Vec3& p, double size) noexcept {
  const Vec3 near = nearest_floats(p);
  return distance(near, p) <= 1e-3 * size ? near : p;
}

float narrow_plainly(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                     LocalPoint* out) noexcept {
  float largest = 0;
  bool finite = true;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f p(positions[first + i] - origin);
    out[i] = {p.x, p.y, p.z, 0.0f};
    largest = std::max(largest, max_norm(p));
    finite = finite && is_finite(p);  // a maximum loses NaN
  }
  return finite ? largest : std::numeric_limits<float>::infinity();
}

float narrow(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
             LocalPoint* out) noexcept {
  if (positions.is_packed_float() && is_float(origin))
    return largest_of(
        kernels().narrow_floats(reinterpret_cast<const float*>(positions.address(first)), count, Vec3f(origin), out));
  return narrow_each(positions, first, count, origin, out, [](std::size_t i) { return i; });
}

float narrow_scattered(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                       const std::uint32_t* to, LocalPoint* out) noexcept {
  if (positions.is_packed_float() && is_float(origin))
    return largest_of(kernels().narrow_scattered(reinterpret_cast<const float*>(positions.address(first)), count,
                                                 Vec3f(origin), to, out));
  return narrow_each(positions, first, count, origin, out, [&](std::size_t i) { return to[i]; });
}

}  // namespace morula::detail
