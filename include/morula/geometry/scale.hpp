// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How large and how small a body may be where squares and cubes of lengths are taken, and lengths that none of it
// concerns.
//
// In double, squares of lengths below 2^-511 vanish and those above 2^511 overflow; areas of areas and volumes do so
// earlier. Whatever builds, cuts, measures or searches therefore takes meshes whose largest |coordinate| M is 0 or in
// one range:
//   nothing overflows  differences are below 2^102, so products of nine lengths are below 2^920; no more are multiplied
//   nothing is lost    a distance whose squares vanish, wholly where a processor flushes denormals, is off by less than
//                      2^-510, and radii carry a pad of at least 2^-48 M >= 2^-148. So a facet may be as small as it
//                      likes beside M: of size 2^-511 or less it counts as a point, and the pad is 2^362 times what
//                      that costs. Products of higher powers that vanish only choose (the facet that is nearest, the
//                      place of a sphere); radii are distances, measured afterwards.
// What proves needs no range: certify() and validate() are right for all finite doubles. A Body has its own, larger at
// the lower end (update/body.hpp).
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>

namespace morula {

inline constexpr double least_usable_scale = 0x1p-100;    ///< about 8e-31
inline constexpr double greatest_usable_scale = 0x1p100;  ///< about 1e30

/// Coordinates about the origin stay below this: squared distances then cannot overflow a float, not even to centers
/// that lie outside the hull of their anchors.
inline constexpr float largest_local_coordinate = 0x1p57f;
/// So does the origin stay below this: what reading at such coordinates costs, 2^-48 of them, is then below 2^52.
inline constexpr double largest_origin_coordinate = 0x1p100;
/// Radii that grow by ratios (approaches 1 and 2) stop here, so that boxes and distances made of them stay finite.
inline constexpr float largest_radius = 0x1p60f;

/// Throws std::invalid_argument, with the remedy, unless the largest |coordinate| of the vertices that facets use is 0
/// or in the range. The mesh must have passed require_usable.
void require_usable_scale(const MeshView& mesh);
/// Is it finite, and are all its numbers within the upper end? Small spheres, and radii of 0, are usable.
bool has_usable_scale(const Sphere& sphere);

/// The length of any finite vector to a few ulps: no square vanishes or overflows. Infinite where the length itself is
/// beyond double.
double scaled_length(const Vec3& v);

}  // namespace morula
