// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Random numbers, sine, cosine and arctangent with the same bits on every machine. The functions of the standard
// library differ between processors and implementations.
#pragma once

#include <cstdint>

namespace morula {

/// A small seeded generator without global state: SplitMix64 [steele2014].
class Random {
 public:
  explicit constexpr Random(std::uint64_t seed) : state_(seed) {}
  constexpr std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// A number, uniform in [0, 1).
  constexpr double uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  constexpr double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

 private:
  std::uint64_t state_;
};

struct SinCos {
  double sin, cos;
};
/// Sine and cosine with an absolute error below 3e-16 for |radians| ≤ 1000. The error grows with the number of turns,
/// but both values belong to one angle for every finite number. NaN for input that is not finite. sin_cos(0) is exactly
/// {0, 1}.
SinCos sin_cos(double radians);

/// Angle of the point (x, y) from the positive x axis, -π…π, like std::atan2(y, x). The relative error is below 5e-16;
/// zeros and infinities give the same results as std::atan2.
double angle_of(double y, double x);

}  // namespace morula
