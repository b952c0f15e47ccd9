// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "geometry/exact_predicates.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <span>

#include "geometry/wide_integers.hpp"

namespace morula::detail {
namespace {

/// (-1)^negative × mantissa × 2^exponent.
struct Number {
  std::uint64_t mantissa;
  int exponent;
  bool negative;
};

Number number(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const int field = static_cast<int>(bits >> 52) & 0x7ff;
  const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
  if (field == 0) return {fraction, -1074, (bits >> 63) != 0};
  return {fraction | std::uint64_t{1} << 52, field - 1075, (bits >> 63) != 0};
}

/// A sum of products of three numbers in fixed point, two's complement: with as many words as their exponents need.
class ExactSum {
 public:
  explicit ExactSum(std::span<const Number> factors) {
    int lowest = 1024, highest = -1074;
    for (const Number& factor : factors) {
      if (factor.mantissa == 0) continue;
      lowest = std::min(lowest, factor.exponent);
      highest = std::max(highest, factor.exponent);
    }
    if (lowest > highest) lowest = highest;
    base_ = 3 * lowest;
    // 159 bits from the highest product, five for the sum of up to 24 of them, one for the sign; a word at each end.
    used_ = static_cast<std::size_t>(3 * (highest - lowest) + 159 + 6) / 64 + 2;
    std::fill_n(words_.begin(), used_, 0);
  }

  void add(const Number& a, const Number& b, const Number& c, bool minus = false) {
    const Product128 ab = product(a.mantissa, b.mantissa);
    if ((ab.low | ab.high) == 0 || c.mantissa == 0) return;
    const Product128 low = product(ab.low, c.mantissa), high = product(ab.high, c.mantissa);
    const std::uint64_t middle = high.low + low.high;
    const std::uint64_t abc[3] = {low.low, middle, high.high + (middle < low.high ? 1 : 0)};
    const auto shift = static_cast<std::size_t>(a.exponent + b.exponent + c.exponent - base_);
    const std::size_t word = shift / 64, bit = shift % 64;
    std::uint64_t shifted[4] = {abc[0] << bit, abc[1] << bit, abc[2] << bit, 0};
    if (bit != 0)
      for (std::size_t k = 0; k < 3; ++k) shifted[k + 1] |= abc[k] >> (64 - bit);
    if ((a.negative != b.negative) != (c.negative != minus))
      subtract(word, shifted);
    else
      add(word, shifted);
  }

  int sign() const {
    if (words_[used_ - 1] >> 63) return -1;
    for (std::size_t k = 0; k < used_; ++k)
      if (words_[k] != 0) return 1;
    return 0;
  }

 private:
  void add(std::size_t word, const std::uint64_t (&x)[4]) {
    std::uint64_t carry = 0;
    for (std::size_t k = word; k < used_ && (k < word + 4 || carry != 0); ++k) {
      const std::uint64_t x_k = k < word + 4 ? x[k - word] : 0, half = words_[k] + x_k;
      words_[k] = half + carry;
      carry = static_cast<std::uint64_t>(half < x_k) + static_cast<std::uint64_t>(words_[k] < carry);
    }
  }
  void subtract(std::size_t word, const std::uint64_t (&x)[4]) {
    std::uint64_t borrow = 0;
    for (std::size_t k = word; k < used_ && (k < word + 4 || borrow != 0); ++k) {
      const std::uint64_t x_k = k < word + 4 ? x[k - word] : 0, half = words_[k] - x_k;
      const bool below = words_[k] < x_k || half < borrow;
      words_[k] = half - borrow;
      borrow = static_cast<std::uint64_t>(below);
    }
  }

  // Exponents from -1074 to 971: at most 3 x 2045 + 165 bits.
  std::array<std::uint64_t, 102> words_;
  std::size_t used_;
  int base_;
};

/// Adds the determinant of rows r, s and t.
void add_determinant(ExactSum& sum, const Number* r, const Number* s, const Number* t, bool minus) {
  sum.add(r[0], s[1], t[2], minus);
  sum.add(r[0], s[2], t[1], !minus);
  sum.add(r[1], s[2], t[0], minus);
  sum.add(r[1], s[0], t[2], !minus);
  sum.add(r[2], s[0], t[1], minus);
  sum.add(r[2], s[1], t[0], !minus);
}

/// Whether the rounded difference is exact [shewchuk1997, theorem 7]; false after an overflow.
bool is_exact_difference(double x, double y, double difference) {
  const double y_seen = x - difference, x_seen = difference + y_seen;
  return (x - x_seen) + (y_seen - y) == 0;
}

/// Writes p minus base as numbers; returns false when a coordinate of the difference is not one double.
bool exact_difference(const Vec3& p, const Vec3& base, Number* row) {
  for (int axis = 0; axis < 3; ++axis) {
    const double difference = p[axis] - base[axis];
    // mutant difference-taken-for-exact: `)) return` -> `) && false) return`
    if (!is_exact_difference(p[axis], base[axis], difference)) return false;
    row[axis] = number(difference);
  }
  return true;
}

int exact_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::array<Number, 12> rows;
  Number *first = rows.data(), *second = first + 3, *third = first + 6, *fourth = first + 9;
  // Neighbors on a grid, and points close to each other, have exact differences: six products instead of 24.
  if (exact_difference(b, a, first) && exact_difference(c, a, second) && exact_difference(d, a, third)) {
    ExactSum sum{std::span(rows).first(9)};
    add_determinant(sum, first, second, third, false);
    return sum.sign();
  }
  for (int axis = 0; axis < 3; ++axis) {
    first[axis] = number(a[axis]), second[axis] = number(b[axis]);
    third[axis] = number(c[axis]), fourth[axis] = number(d[axis]);
  }
  ExactSum sum(rows);
  add_determinant(sum, second, third, fourth, false);
  add_determinant(sum, first, third, fourth, true);
  add_determinant(sum, first, second, fourth, false);
  add_determinant(sum, first, second, third, true);
  return sum.sign();
}

int exact_orient2d(double ax, double ay, double bx, double by, double cx, double cy) {
  const std::array<Number, 7> n{number(ax), number(ay), number(bx), number(by), number(cx), number(cy), number(1.0)};
  ExactSum sum(n);
  sum.add(n[0], n[3], n[6]);
  sum.add(n[1], n[2], n[6], true);
  sum.add(n[2], n[5], n[6]);
  sum.add(n[3], n[4], n[6], true);
  sum.add(n[4], n[1], n[6]);
  sum.add(n[5], n[0], n[6], true);
  return sum.sign();
}

int exact_cross2d(const std::array<double, 8>& xy) {
  std::array<Number, 9> n;
  for (std::size_t k = 0; k < 8; ++k) n[k] = number(xy[k]);
  n[8] = number(1.0);
  ExactSum sum(n);
  for (const std::size_t b : {std::size_t{2}, std::size_t{0}})
    for (const std::size_t d : {std::size_t{6}, std::size_t{4}}) {
      const bool minus = (b == 0) != (d == 4);
      sum.add(n[b], n[d + 1], n[8], minus);
      sum.add(n[b + 1], n[d], n[8], !minus);
    }
  return sum.sign();
}

// Sign of |c - c'|^2 - (r - r')^2.
int exact_sign_of_gap(const Sphere& outer, const Sphere& inner) {
  std::array<Number, 9> n{};
  for (int axis = 0; axis < 3; ++axis) {
    n[static_cast<std::size_t>(2 * axis)] = number(outer.center[axis]);
    n[static_cast<std::size_t>(2 * axis + 1)] = number(inner.center[axis]);
  }
  n[6] = number(outer.radius), n[7] = number(inner.radius), n[8] = number(1.0);
  ExactSum sum(n);
  const Number& one = n[8];
  for (std::size_t i = 0; i < 8; i += 2) {
    const bool minus = i == 6;
    sum.add(n[i], n[i], one, minus);
    sum.add(n[i + 1], n[i + 1], one, minus);
    sum.add(n[i], n[i + 1], one, !minus);
    sum.add(n[i], n[i + 1], one, !minus);
  }
  return sum.sign();
}

}  // namespace

bool encloses(const Sphere& outer, const Sphere& inner) {
  // mutant encloses-larger: `if (inner.radius > outer.radius) return false` -> ``
  if (inner.radius > outer.radius) return false;
  const double squared = squared_distance(outer.center, inner.center);
  const double room = outer.radius - inner.radius, squared_room = room * room;
  // A square of a difference (1 + e)^3, the sum of three of them (1 + e)^5, their difference (1 + e)^6. Allowed: 8 e,
  // and the error of underflow.
  // mutant encloses-no-error: `8` -> `0`
  // mutant encloses-underflow: `(squared + squared_room) + TrianglePlane::underflow` -> `(squared + squared_room)`
  const double error = 8 * 0x1p-53 * (squared + squared_room) + TrianglePlane::underflow;
  if (squared_room - squared > error) return true;
  if (squared - squared_room > error) return false;
  // mutant encloses-touching: `<= 0` -> `< 0`
  return exact_sign_of_gap(outer, inner) <= 0;
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, Projection projection) {
  if (const int sign = certain_orient2d(a, b, c, projection); sign != 0) return sign;
  const auto [first, second] = projection;
  return exact_orient2d(a[first], a[second], b[first], b[second], c[first], c[second]);
}

int cross2d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, Projection projection) {
  const auto [first, second] = projection;
  const Vec3 u = b - a, v = d - c;
  const double left = u[first] * v[second], right = u[second] * v[first], value = left - right;
  // The same operations as in certain_orient2d(), hence the same error.
  const double error = orient2d_relative_error * (std::abs(left) + std::abs(right)) + orient2d_underflow;
  if (value > error) return 1;
  if (value < -error) return -1;
  return exact_cross2d({a[first], a[second], b[first], b[second], c[first], c[second], d[first], d[second]});
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Triangle t{a, b, c};
  return TrianglePlane(t).side(d).sign;
}

TrianglePlane::Side TrianglePlane::exact_side(const Vec3& d, double value) const {
  const int sign = exact_orient3d((*t_)[0], (*t_)[1], (*t_)[2], d);
  // The value is rounded to double, but never of the opposite sign; NaN after an overflow.
  // mutant exact-side-keeps-its-value: `0 || !(value * sign > 0)` -> `0`
  if (sign == 0 || !(value * sign > 0)) value = 0;
  return {sign, value};
}

}  // namespace morula::detail
