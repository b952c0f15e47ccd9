// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The sphere, among a few, whose power cell holds a point.
#pragma once

#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <span>

namespace morula::detail {

/// The candidate of least power at x; the first of equals. candidates: indices into spheres, at least one.
inline std::uint32_t power_cell_of(const Vec3& x, std::span<const Sphere> spheres,
                                   std::span<const std::uint32_t> candidates) {
  std::uint32_t best = candidates[0];
  double least = power(spheres[best], x);
  for (const std::uint32_t i : candidates.subspan(1)) {
    const double p = power(spheres[i], x);
    // mutant power-cut-of-equals: `p <` -> `p <=`
    if (p < least) least = p, best = i;
  }
  return best;
}

}  // namespace morula::detail
