// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Narrowing upwards: it makes a radius in float no smaller than the one in double.
#pragma once

#include <bit>
#include <cstdint>

namespace morula::detail {

/// The least float that is not below x; NaN for NaN. x may be 0, infinite, beyond all floats or below the least of
/// them.
///
/// The nearest float is the result or, if it is below x, the float below the result: then the next float upwards is the
/// result. Bit patterns of floats of one sign are in the order of their magnitudes, subnormal ones and infinity
/// included, so the next float upwards is the next pattern for 0 and above, and the preceding pattern below 0: from the
/// largest float to infinity, from -infinity to the lowest float, from the least negative one to -0, as in nextafter.
/// -0 itself is never below an x that is rounded to it: such an x is -0 or negative. The function has no branch, since
/// half of all x are rounded down.
inline float rounded_up(double x) {
  const float nearest = static_cast<float>(x);
  const auto bits = std::bit_cast<std::uint32_t>(nearest);
  // mutant rounded-up-to-nearest: `static_cast<double>(nearest) < x` -> `false`
  const std::uint32_t below = static_cast<double>(nearest) < x ? 1u : 0u;
  // mutant rounded-up-below-zero: `nearest < 0 ? bits - below : bits` -> `bits`
  return std::bit_cast<float>(nearest < 0 ? bits - below : bits + below);
}

}  // namespace morula::detail
