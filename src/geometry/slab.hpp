// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Slab between two sets of facets: a lower bound of their distance along one line.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/triangle.hpp>

namespace morula::detail {

// How far facets reach across the line through the best points so far: what is farther apart along it than these points
// is farther apart. Sharper than spheres, and one subtraction per pair.
//
// The direction is exact as it is, and its size does not matter: it is scaled by a power of two, so that no square of
// it vanishes. A difference w and its product with the direction are off by 6 u |direction| |w|, below 11 u of its
// largest coordinate; allowed 16 u each.
class Slab {
 public:
  Slab(const Vec3& from, const Vec3& direction)
      : from_(from), direction_(ordinary(direction)), size_(length(direction_)) {}
  // Not below where the triangle ends on the direction's side (side = 1) or, negated, on the other (side = -1).
  double end(const Triangle& t, double side) const {
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : t) {
      const Vec3 w = p - from_;
      // mutant slab-ends: `) + 0x1p-49 * size_ * max_norm(w))` -> `)  )`
      farthest = std::max(farthest, side * dot(direction_, w) + 0x1p-49 * size_ * max_norm(w));
    }
    return farthest;
  }
  // Ends farther apart than this are farther apart than the distance.
  // mutant slab-width: `size_ * (1 + 0x1p-48)` -> `size_`
  double width(double distance) const { return distance * size_ * (1 + 0x1p-48); }

  /// The direction with a largest |coordinate| of 1…2; zero and what is not finite stay as they are.
  static Vec3 ordinary(const Vec3& direction) {
    const double largest = max_norm(direction);
    if (!(largest > 0) || !std::isfinite(largest)) return direction;
    const int exponent = std::ilogb(largest);
    return {std::ldexp(direction.x, -exponent), std::ldexp(direction.y, -exponent), std::ldexp(direction.z, -exponent)};
  }

 private:
  Vec3 from_, direction_;
  double size_;
};

}  // namespace morula::detail
