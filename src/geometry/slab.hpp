// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Slab between two sets of facets: a lower bound of their distance along one line.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/triangle.hpp>

namespace morula::detail {

// The extents of facets along the line through the best points so far: facets that are farther apart along it than
// these points are farther apart. It is sharper than spheres, and costs one subtraction per pair.
//
// The direction counts as exact, and its length is irrelevant: it is scaled by a power of two, so that no square of it
// underflows. A difference w and its product with the direction are off by 6 u |direction| |w|, below 11 u of its
// largest coordinate; the allowance is 16 u each.
class Slab {
 public:
  Slab(const Vec3& from, const Vec3& direction)
      : from_(from), direction_(ordinary(direction)), size_(length(direction_)) {}
  // An upper bound of the triangle's end on the direction's side (side = 1) or, negated, of its end on the other (side
  // = -1).
  double end(const Triangle& t, double side) const {
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : t) {
      const Vec3 w = p - from_;
      // mutant slab-ends: `) + 0x1p-49 * size_ * max_norm(w))` -> `)  )`
      farthest = std::max(farthest, side * dot(direction_, w) + 0x1p-49 * size_ * max_norm(w));
    }
    return farthest;
  }
  // The width for a distance: facets whose ends are farther apart than the width are farther apart than the distance.
  // mutant slab-width: `size_ * (1 + 0x1p-48)` -> `size_`
  double width(double distance) const { return distance * size_ * (1 + 0x1p-48); }

  /// The direction with a largest |coordinate| of 1…2; zero and values that are not finite stay unchanged.
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
