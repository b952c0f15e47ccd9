// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Narrowing upwards: what a radius in float needs that is to be no smaller than one in double.
#pragma once

#include <cmath>
#include <limits>

namespace morula::detail {

/// The least float that is not below x.
inline float rounded_up(double x) {
  const float nearest = static_cast<float>(x);
  return static_cast<double>(nearest) < x ? std::nextafter(nearest, std::numeric_limits<float>::infinity()) : nearest;
}

}  // namespace morula::detail
