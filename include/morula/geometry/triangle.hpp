// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Triangle mathematics, shared by all layers above.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/vector.hpp>

namespace morula {

using Triangle = std::array<Vec3, 3>;

/// Vector along the normal, of twice the triangle's area.
inline Vec3 area_vector(const Triangle& t) {
  return cross(t[1] - t[0], t[2] - t[0]);
}
inline double area(const Triangle& t) {
  return 0.5 * length(area_vector(t));
}

/// Barycentric coordinates on a facet. A coordinate is exactly zero on the facet's opposite edge, and stays so in cuts.
using Barycentric = std::array<double, 3>;
/// The corners of an uncut facet.
inline constexpr std::array<Barycentric, 3> whole_facet{Barycentric{1, 0, 0}, Barycentric{0, 1, 0},
                                                        Barycentric{0, 0, 1}};

/// Point b0 p0 + b1 p1 + b2 p2.
inline Vec3 at_barycentric(const Triangle& t, const Barycentric& b) {
  return t[0] * b[0] + t[1] * b[1] + t[2] * b[2];
}

struct TrianglePoint {
  Vec3 point;
  Barycentric barycentric;  ///< exactly zero on the opposite edge
  double squared_distance;
};
/// The point of the closed triangle nearest to p. Triangles without area are segments or points. [ericson2005, 5.1.5]
TrianglePoint closest_point(const Triangle& t, const Vec3& p);

/// Signed solid angle of t seen from p, in (−2π, 2π]; positive if p is behind the facet (inside a closed mesh). Zero if
/// p is a corner or lies exactly in the plane of t. A triangle without area, seen from near its own line, can have any
/// angle that rounding gives. [vanoosterom1983]
double solid_angle(const Triangle& t, const Vec3& p);

/// A point of a surface: its facet, and its position on the facet and in space. `point` equals at_barycentric of the
/// facet's triangle up to rounding: in mesh coordinates, or in world coordinates for a collider.
struct SurfacePoint {
  std::uint32_t facet;
  Barycentric barycentric;
  Vec3 point;
};

}  // namespace morula
