// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Relative looseness: the measure that compares trees of one surface.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace morula::detail {

/// Looseness below this is tight enough: ratios of smaller figures say nothing.
inline constexpr double negligible_looseness = 1e-3;

/// The root is one ball whatever the tree: it counts only if it is the only level.
inline std::size_t first_counted_level(std::size_t levels) {
  return levels > 1 ? 1 : 0;
}

/// Σ E / E of home, over the levels that count.
inline double relative_looseness(std::span<const double> looseness, std::span<const double> home) noexcept {
  double sum = 0;
  for (std::size_t level = first_counted_level(looseness.size()); level < looseness.size(); ++level)
    sum += looseness[level] / std::max(negligible_looseness, home[level]);
  return sum;
}

/// The largest E / E at the pose that the tree was built for, over the levels that count.
inline double largest_growth(std::span<const double> looseness, std::span<const double> at_build) noexcept {
  double largest = 0;
  for (std::size_t level = first_counted_level(looseness.size()); level < looseness.size(); ++level)
    largest = std::max(largest, looseness[level] / std::max(negligible_looseness, at_build[level]));
  return largest;
}

}  // namespace morula::detail
