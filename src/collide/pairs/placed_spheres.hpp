// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A body's spheres in the world, grown so that they contain the world's surface in real numbers.
//
// Let u = 2^-53, c and r a node's center (in double about the origin of the mesh) and radius, A a bound of
// |coordinates| in the sphere, T the largest |coordinate| of the translation, d = deviation_from_rigid(transform). The
// body guarantees that the region's points lie within r of c, for the caller's positions x
// (docs/explanation/update_cost.md, Rounding). The world's facets are hulls of vertices v = fl(R x + t), so a point of
// one is R q + t + e with q in the region and e a mean of rounding errors.
//   stretch      |R q - R c| <= |R| r, and |R|^2 <= 1 + 3 d                     |R| <= 1 + 1.5 d
//                allowed: 1 + 2 d + 2^-49, which also pays for computing d and for the product with r
//   reading      fl(origin + center): u A per coordinate, as a length below     1.8 u A
//   placing      three products and three sums per coordinate, sum |R_ij x_j| <= 1.8 A: below 7 u A + u T, as a length
//                below 12.2 u A + 1.8 u T; for the vertices and for the center   24.4 u A + 3.6 u T
//   Together below 27 u A + 4 u T. Allowed: 2^-46 (A + T) = 128 u (A + T).
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>

namespace morula::detail {

class PlacedSpheres {
 public:
  explicit PlacedSpheres(const Collider& collider)
      : transform_(collider.transform()),
        spheres_(collider.sphere_state().spheres),
        origin_(collider.sphere_state().origin),
        // mutant placed-stretch: `2 * deviation_from_rigid(transform_) + 0x1p` -> `0x1p`
        // mutant placed-stretch-less: `2` -> `0.25`
        stretch_(1 + 2 * deviation_from_rigid(transform_) + 0x1p-49),
        translation_(max_norm(transform_.translation)) {}

  Sphere operator()(std::uint32_t node) const {
    const Spheref& s = spheres_[node];
    const Vec3 center = origin_ + Vec3(s.center);
    const double radius = s.radius;
    // mutant placed-rounding: `0x1p-46` -> `0`
    const double pad = 0x1p-46 * (max_norm(center) + radius + translation_);
    return {transform_(center), radius * stretch_ + pad};
  }

 private:
  RigidTransform transform_;
  std::span<const Spheref> spheres_;
  Vec3 origin_;
  double stretch_, translation_;
};

/// A lower bound of the distance between points of two spheres; negative where the spheres overlap.
///
/// The differences of centers are off by u each, the length by 3 u of it; sums of radii by u. Underflow and overflow:
/// squares underflow only below 2^-500, where pads are larger (and a facet's sphere has a radius of that); they stay
/// finite below 2^500.
inline double gap_below(const Sphere& a, const Sphere& b) {
  // mutant gap-distance: `* (1 - 0x1p-49) -` -> `-`
  // mutant gap-radii: `(a.radius + b.radius) * (1 + 0x1p-51)` -> `(a.radius + b.radius)`
  return distance(a.center, b.center) * (1 - 0x1p-49) - (a.radius + b.radius) * (1 + 0x1p-51);
}

}  // namespace morula::detail
