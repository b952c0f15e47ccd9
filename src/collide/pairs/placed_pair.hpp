// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Placed pair: one body's spheres in the other's coordinates, and the allowances of pair tests for rounding.
//
// Local coordinates of a body are about its origin, without its transform. A test compares a sphere (c_a, r_a) of a
// with a sphere (c_b, r_b) of b, moved into a's coordinates by c' = M c_b + u with M = R_a^T R_b, u = R_a^T (W_b - W_a)
// and W = R origin + t. It returns "separated" only when no point of the world lies in both regions. Let e = 2^-24, v =
// 2^-53,
// |.|_1 the sum of absolute coordinates, U the largest |coordinate| of u, A the sum over both bodies of the largest
// |coordinates| of origin and translation.
//
// A common point is W_a + R_a l_a = W_b + R_b l_b up to double rounding, with |l_a - c_a| <= r_a and |l_b - c_b| <=
// r_b, so |c_a - c'| <= r_a + |M| r_b + |E l_a| with E = R_a^T R_a - I, and |l_a| is below |u| + |l_b| and a little:
//   not quite rigid entries of R R^T - I up to d = 1e-9: |M| <= 1 + 4 d, |E l_a| <= 3 d |l_a|. Together below
//                   16 d (|c_b|_1 + U + r_b) = 0.3 e of it
//   world           vertices R x + t rounded to double, W, origin + center, the difference of the W: below
//                   60 v (A + |c_b|_1 + U + r_b). Allowed: 2^-46 A = 128 v A; the rest is nothing beside the next lines
//   moving          M and u narrowed, three products, three sums in float: per coordinate below 4 e (|c_b|_1 + U), as a
//                   length 7 e of it. Allowed with what is not rigid: 2^-20 = 16 e of |c_b|_1, U and r_b
//   distance        three differences e, squares and sums: d below (1 + 2.5 e); sum of radii and its square 1.5 e; the
//                   grown radii below, 3 e each. In all below 8 e of r_a + r_b. Allowed: 2^-20 of each = 16 e
//   underflow       squares below 2^-126 may vanish. Allowed: 2^-60, whose square is 2^-120.
// So r_a counts as (1 + 2^-20) r_a, and r_b as (1 + 2^-19) r_b + 2^-20 |c_b|_1 + pad, where pad = 2^-20 U + 2^-46 A +
// 2^-60 + margin, rounded up. The rest of the allowances covers second-order terms.
//
// Range: local coordinates stay below 2^57 and radii below 2^61. With |u| of 2^62 or more the bodies are apart, and any
// u that large proves it; a pad of 2^58 or more makes all pairs overlap.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>

namespace morula::detail {

/// The numbers with which a kernel moves spheres of b, in float.
struct NarrowPair {
  float rows[3][3];
  float translation[3];
  float pad;
};

/// The same in double, and the transforms to the world.
struct PlacedPair {
  std::array<Vec3, 3> rows;  ///< rows of M
  Vec3 translation;          ///< u
  // To the world, about W_a: R_a c_a and R_b c_b + W_b - W_a. Distances there differ by 2 d of themselves, see above.
  std::array<Vec3, 3> world_a, world_b;
  Vec3 world_shift;   ///< W_b - W_a
  Vec3 world_origin;  ///< W_a
  double margin = 0;
  double pad = 0;       ///< pad, margin left out
  double rounding = 0;  ///< part of the pad that covers the rounding of the world's coordinates
  NarrowPair narrow{};

  Vec3 moved(const Vec3f& center) const {
    const Vec3 c(center);
    return Vec3{dot(rows[0], c), dot(rows[1], c), dot(rows[2], c)} + translation;
  }
  /// The growth of each of two spheres by a test, at most, margin left out.
  double allowance(const Spheref& a, const Spheref& b) const {
    const auto size = [](const Spheref& s) {
      return static_cast<double>(std::abs(s.center.x) + std::abs(s.center.y) + std::abs(s.center.z) + 2 * s.radius);
    };
    return 0x1p-20 * (static_cast<double>(a.radius) + size(b)) * (1 + 0x1p-10) + pad;
  }
};

/// margin: finite, not negative.
PlacedPair placed_pair(const Collider& a, const Collider& b, double margin);
/// The pair for M and u. coordinates: A.
PlacedPair placed_pair(const RigidTransform& relative, double coordinates, double margin);

}  // namespace morula::detail
