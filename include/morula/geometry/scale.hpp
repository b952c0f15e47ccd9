// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The range of lengths for functions that square and cube lengths, and functions on lengths without such a limit.
//
// In double, squares of lengths below 2^-511 vanish and squares of lengths above 2^511 overflow; squared areas and
// volumes do so earlier. Functions that build, cut, measure or search therefore take meshes whose largest |coordinate|
// M is 0 or in one range:
//   no overflow  differences are below 2^102, so products of nine lengths are below 2^920; no function multiplies more
//   no loss      a distance whose squares vanish, completely on a processor that flushes denormals, is off by less than
//                2^-510, and radii carry a pad of at least 2^-48 M >= 2^-148. So a facet may be arbitrarily small
//                compared with M: a facet of size 2^-511 or less counts as a point, and the pad is 2^362 times this
//                error. Products of higher powers that vanish only affect choices (the nearest facet, the place of a
//                sphere); radii are distances, measured afterwards.
// Proofs need no range: certify() and validate() are right for all finite doubles. A Body has its own range, larger at
// the lower end (update/body.hpp).
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>

namespace morula {

inline constexpr double least_usable_scale = 0x1p-100;    ///< about 8e-31
inline constexpr double greatest_usable_scale = 0x1p100;  ///< about 1e30

/// Coordinates about the origin stay below this, so squared distances cannot overflow a float, not even to centers
/// outside the hull of their anchors.
inline constexpr float largest_local_coordinate = 0x1p57f;
/// The origin stays below this, so the rounding of a position at such coordinates, 2^-48 of them, is below 2^52.
inline constexpr double largest_origin_coordinate = 0x1p100;
/// Radii that grow by ratios (approaches 1 and 2) are limited to this, so that their boxes and distances stay finite.
inline constexpr float largest_radius = 0x1p60f;

/// Throws std::invalid_argument, with the remedy, unless the largest |coordinate| of the vertices that facets use is 0
/// or in the range. The mesh must have passed require_usable.
void require_usable_scale(const MeshView& mesh);
/// True if the sphere is finite, its radius is not negative, and its numbers do not exceed the upper end of the range.
/// Small spheres, and radii of 0, are usable.
bool has_usable_scale(const Sphere& sphere);

/// The length of any finite vector to a few ulps: no square vanishes or overflows. Infinite if the length exceeds
/// double.
double scaled_length(const Vec3& v);

}  // namespace morula
