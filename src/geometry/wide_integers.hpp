// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Integers of 128 bits: the compiler's, or a class with the same results where it has none (MSVC, 32-bit machines).
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace morula::detail {

/// A product of two numbers of 64 bits.
struct Product128 {
  std::uint64_t low, high;
};

/// By products of 32 bits.
constexpr Product128 product_by_halves(std::uint64_t a, std::uint64_t b) {
  constexpr std::uint64_t half = 0xffffffff;
  const std::uint64_t low = (a & half) * (b & half), first = (a >> 32) * (b & half), second = (a & half) * (b >> 32);
  const std::uint64_t middle = (low >> 32) + (first & half) + (second & half);
  return {middle << 32 | (low & half), (a >> 32) * (b >> 32) + (first >> 32) + (second >> 32) + (middle >> 32)};
}

/// Two's complement; sums and products are those modulo 2^128.
class Words128 {
 public:
  constexpr Words128(std::int64_t x) : low_(static_cast<std::uint64_t>(x)), high_(x < 0 ? ~std::uint64_t{0} : 0) {}

  friend constexpr Words128 operator+(const Words128& a, const Words128& b) {
    const std::uint64_t low = a.low_ + b.low_;
    return {low, a.high_ + b.high_ + (low < b.low_ ? 1 : 0)};
  }
  friend constexpr Words128 operator-(const Words128& a, const Words128& b) {
    return {a.low_ - b.low_, a.high_ - b.high_ - (a.low_ < b.low_ ? 1 : 0)};
  }
  friend constexpr Words128 operator*(const Words128& a, const Words128& b) {
    const Product128 low = product_by_halves(a.low_, b.low_);
    return {low.low, low.high + a.low_ * b.high_ + a.high_ * b.low_};
  }
  friend constexpr bool operator>(const Words128& a, const Words128& b) {
    const auto high = static_cast<std::int64_t>(a.high_), other = static_cast<std::int64_t>(b.high_);
    return high > other || (high == other && a.low_ > b.low_);
  }
  /// The nearest double; of two, the even one.
  explicit operator double() const {
    const bool negative = high_ >> 63 != 0;
    const Words128 size = negative ? Words128(0) - *this : *this;
    const double rounded = size.high_ == 0 ? static_cast<double>(size.low_) : size.rounded_top();
    return negative ? -rounded : rounded;
  }

 private:
  constexpr Words128(std::uint64_t low, std::uint64_t high) : low_(low), high_(high) {}
  // The 64 bits from the highest one on have eleven more than a double; the last of them also stands for all below.
  double rounded_top() const {
    const int shift = std::countl_zero(high_);
    const std::uint64_t top = shift == 0 ? high_ : high_ << shift | low_ >> (64 - shift);
    const std::uint64_t rest = low_ << shift;
    return std::ldexp(static_cast<double>(top | (rest != 0 ? 1 : 0)), 64 - shift);
  }

  std::uint64_t low_, high_;
};

#ifdef __SIZEOF_INT128__
__extension__ typedef __int128 Int128;
inline Product128 product(std::uint64_t a, std::uint64_t b) {
  __extension__ typedef unsigned __int128 Unsigned128;
  const Unsigned128 both = static_cast<Unsigned128>(a) * b;
  return {static_cast<std::uint64_t>(both), static_cast<std::uint64_t>(both >> 64)};
}
#else
using Int128 = Words128;
inline Product128 product(std::uint64_t a, std::uint64_t b) {
  return product_by_halves(a, b);
}
#endif

}  // namespace morula::detail
