// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scale: the range of mesh coordinates for which squares and products of lengths neither overflow nor vanish.
//
// In double, the square of a length below 2^-511 vanishes, and that of a length above 2^511 overflows. Products of
// areas and volumes do so for lengths nearer to 1. So functions that build, cut, measure or search require that the
// largest |coordinate| M of a mesh is 0 or between least_usable_scale and greatest_usable_scale. In this range
//   no overflow  lengths are below 2^102, so products of nine lengths are below 2^920; no function multiplies more
//   no loss      a distance whose squares vanish is off by less than 2^-510, even if the processor flushes denormals.
//                Radii carry a pad of at least 2^-48 M, which is 2^-148 or more: 2^362 times this error. So facets may
//                be arbitrarily small compared with M; a facet of size 2^-511 or less counts as a point. Products of
//                more lengths that vanish affect choices alone, such as the nearest facet or the place of a sphere;
//                radii are computed afterwards, from distances.
// certify() and validate() need no range: they are correct for all finite doubles. A Body has another range, without a
// lower limit (update/body.hpp).
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>

namespace morula {

inline constexpr double least_usable_scale = 0x1p-100;    ///< about 8e-31
inline constexpr double greatest_usable_scale = 0x1p100;  ///< about 1e30

/// Largest |coordinate| relative to a body's origin that an update accepts. Squared distances then do not overflow a
/// float, even to centers outside the hull of their anchors.
inline constexpr float largest_local_coordinate = 0x1p57f;
/// Largest |coordinate| of a body's origin that an update accepts. The pad for the rounding of positions there, 2^-48
/// of the coordinate, is then at most 2^52.
inline constexpr double largest_origin_coordinate = 0x1p100;
/// Largest radius that rules without a guarantee of cover write; approach1 and approach2 multiply radii by ratios.
/// Boxes of spheres and distances between them then stay finite. PosedSpheres::set() rejects larger radii.
inline constexpr float largest_radius = 0x1p60f;

/// Throws std::invalid_argument, with the remedy, unless the largest |coordinate| of the vertices that facets use is 0
/// or in the range above. require_usable() must accept the mesh.
void require_usable_scale(const MeshView& mesh);
/// True if the center's coordinates and the radius are numbers of at most greatest_usable_scale in absolute value, and
/// the radius is not negative. There is no lower limit: radii of 0 are usable.
bool has_usable_scale(const Sphere& sphere);

/// The length of any finite vector, to a few units in the last place: no square vanishes or overflows. Infinite if the
/// length exceeds the largest double; length(v) for vectors that are not finite.
double scaled_length(const Vec3& v);

}  // namespace morula
