// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Exact decisions about two bodies in general position: body a is translated by the vector d = (e, e^2, e^3) for an
// infinitely small e > 0, so that no vertex of one body lies in the plane of a facet of the other, and no edges meet.
//
// Each predicate is the sign of a polynomial in d. Its value at d = 0 decides; if that is 0, the part that is linear in
// d decides, and that is a product of d with a vector whose first component other than 0 gives the sign. Higher parts
// vanish:
//   orient3d(t, p + d) = orient3d(t, p) + n . d, n the normal of t;
//   orient3d(p + d, q + d, g, h) = u x (v - d) . (w - d), where u = q - p, v = g - p, w = h - p
//                                = u x v . w + d . (u x (h - g)), because u x d . d = 0.
// A sign stays 0 for all d only in two cases: t has no area; or u and h - g are parallel. So all decisions describe the
// real bodies after one translation, as small as one likes, and are consistent: a line goes into a closed surface as
// often as it comes out, and the crossings of a facet with another are none or two points.
#pragma once

#include "geometry/exact_predicates.hpp"

namespace morula::detail {

/// Sign of the product of the normal of t with the translation of a; 0 only if t has no area.
inline int translation_across(const Triangle& t) {
  for (const Projection& projection : projections)
    if (const int sign = orient2d(t[0], t[1], t[2], projection); sign != 0) return sign;
  return 0;
}

/// The plane of a facet of one body, for vertices of the other.
class ShiftedPlane {
 public:
  /// t: stays in place. of_b: true for a facet of b.
  ShiftedPlane(const Triangle& t, bool of_b) : t_(&t), plane_(t), moves_(of_b ? 1 : -1) {}
  /// The sign is 0 only if the facet has no area. The value is that of TrianglePlane.
  TrianglePlane::Side side(const Vec3& p) const {
    TrianglePlane::Side side = plane_.side(p);
    // mutant patches-in-plane: `moves_ * translation_across(*t_)` -> `1`
    if (side.sign == 0) side = {moves_ * translation_across(*t_), 0.0};
    return side;
  }

 private:
  const Triangle* t_;
  TrianglePlane plane_;
  int moves_;  // 1 if the points move relative to the facet by d, -1 if by -d
};

/// Sign of orient3d(p, q, g, h) for an edge pq of a and an edge gh of b; 0 only if the edges are parallel.
inline int shifted_edges(const Vec3& p, const Vec3& q, const Vec3& g, const Vec3& h) {
  const Triangle t{p, q, g};
  if (const int sign = TrianglePlane(t).side(h).sign; sign != 0) return sign;
  for (const Projection& projection : projections)
    // mutant patches-edges-meet: `cross2d(p, q, g, h, projection)` -> `cross2d(g, h, p, q, projection)`
    if (const int sign = cross2d(p, q, g, h, projection); sign != 0) return sign;
  return 0;
}

}  // namespace morula::detail
