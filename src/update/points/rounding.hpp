// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rounding of radii: the error budget of every distance that an update computes.
//
// Let e = 2^-24, M the largest |coordinate| of a vertex about the frame's origin (after narrowing to float), A the
// largest |coordinate| of origin, points and center in mesh units, and s the largest |1 - sum of weights| over the
// cover's cut points. Per coordinate:
//   narrowing       p - origin in double, then to float                                        e M
//   cut points      v0 + w1 (v1 - v0) + w2 (v2 - v0) in float, where v0 has the largest weight, so w1 + w2 <= 2/3 and
//                   |w1 (v1 - v0)| + |w2 (v2 - v0)| <= 4/3 M: weights narrowed 4/3 e M, differences 4/3 e M,
//                   products 4/3 e M, two sums 2 e M                                           6 e M
//                   With the narrowing: 7 e M, as a length below 12.2 e M. Allowed with hulls: 2^-20 M = 16 e M.
//   hulls           corners that are left out lie within hull_tolerance = 2^-30 (and 2^-50 for finding that out) in
//                   |x| + |y| of the hull of those tested (facet_hull.hpp), twice that for nodes above leaves
//                   (share_levels); x and y are weights of two edges, no longer than 2 sqrt(3) M each, so below
//                   2 x 3.5 x 2^-30 M = 0.11 e M, 12.4 e M with the line above
//   distance        squared in float: differences e, products e, two sums; (1 + e)^5 in all, so 2.5 e of the distance,
//                   and the root is taken in double. Allowed: 2^-22 of it = 4 e.
//   underflow       products below 2^-126 may vanish, even a processor that flushes to zero loses no more:
//                   3 x 2^-126 of the square, below 2^-62 of the distance. Allowed: 2^-62.
//   reading         origin + center in double 2^-53 A, a cut point as a weighted sum of mesh coordinates
//                   3 x 2^-53 A and s A: as a length below 7 x 2^-53 A + 2 s A. A corner that is left out is the same
//                   combination of those tested as far as x and y go; their first weights differ by up to 2 s, which
//                   moves it by up to 2 s among points of the facet: below 3.5 s M. Allowed: 2^-48 A, which
//                   rounded_up_radius and so certify() also require, and 6 s A.
// The rest of the allowances is a thousand times the second-order terms and the rounding of double arithmetic.
#pragma once

#include <morula/geometry/scale.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/vector.hpp>
#include <span>

#include "geometry/rounded_up.hpp"
#include "update/points/kernels.hpp"

namespace morula::detail {

/// The inputs of the allowances for the points of one frame.
struct Rounding {
  double largest_coordinate = 0;         ///< M
  double largest_origin_coordinate = 0;  ///< |origin|
  double weight_slack = 0;               ///< s

  bool operator==(const Rounding&) const = default;

  /// Returns the radius of a sphere about `center` that contains spheres, whose farthest point is `reach` from it:
  /// computed in double.
  float wrapping_radius(double reach, const Vec3f& center) const {
    const double mesh_coordinate =
        largest_origin_coordinate + largest_coordinate + static_cast<double>(max_norm(center));
    // mutant wrapping-sum: `* (1 + 0x1p-48) +` -> `+`
    // mutant wrapping-reading: `48 * mesh_coordinate + 0x1p-` -> ``
    // mutant wrapping-reading-less: `48 *` -> `53 *`
    return rounded_up(reach * (1 + 0x1p-48) + 0x1p-48 * mesh_coordinate + 0x1p-62);
  }

  /// Returns the radius of a sphere about `center` that contains these spheres. It may be larger than largest_radius,
  /// if the spheres that it contains are about as large.
  float wrapping_radius(std::span<const Spheref> spheres, const Vec3f& center) const {
    double reach = 0;
    for (const Spheref& s : spheres)
      reach = std::max(reach, distance(Vec3(center), Vec3(s.center)) + static_cast<double>(s.radius));
    return wrapping_radius(reach, center);
  }

  /// Returns the radius of a sphere about `center` that contains points with this largest squared distance, computed in
  /// float.
  float covering_radius(float squared_distance, const Vec3f& center) const {
    const RadiusAllowances allowed = allowances();
    const double farthest = std::sqrt(static_cast<double>(squared_distance));
    const double mesh_coordinate = allowed.coordinate + static_cast<double>(max_norm(center));
    const double pad = allowed.least + allowed.per_coordinate * mesh_coordinate + RadiusAllowances::of_underflow;
    return rounded_up(farthest * RadiusAllowances::of_distance + pad);
  }

  /// The allowances of covering_radius, and of Kernels::covering_radii, which computes many at once.
  RadiusAllowances allowances() const {
    // mutant covering-narrowing: `0x1p-20 * largest_coordinate` -> `0`
    // mutant covering-narrowing-less: `20` -> `23`
    // mutant covering-reading: `0x1p-48 + 6` -> `6`
    // mutant covering-reading-less: `48` -> `52`
    // mutant covering-slack: `48 + 6 * weight_slack` -> `48`
    // mutant covering-slack-less: `6 * weight_slack` -> `weight_slack`
    return {largest_origin_coordinate + largest_coordinate, 0x1p-48 + 6 * weight_slack, 0x1p-20 * largest_coordinate};
  }
};

}  // namespace morula::detail
