// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Exact decisions about one surface in general position: vertex i is translated by d_i = (e_i, e_i^2, e_i^3), where
// e_0 > 0 is infinitely small, and each e_(i+1) is infinitely small compared with all powers of e_i.
//
// The sign of four points is the first of these that is not 0, for the points q0 q1 q2 q3 in the order of their
// indices. D is orient3d; N(a, b, c) is (b - a) x (c - a), so D(a, b, c, x) = N(a, b, c) . (x - a). D is linear in each
// point, so it is enough to translate one point after the other, the one with the lowest index first:
//   D(q0, q1, q2, q3)
//   its part linear in d_0: -N(q1, q2, q3) . d_0, the sign of the first component that is not 0
// If N(q1, q2, q3) = 0, then D = 0 for all d_0. q0 stays translated:
//   the part linear in d_1: N(q0 + d_0, q2, q3) . d_1, where with u = q3 - q2
//   N(q0 + d_0, q2, q3) = N(q0, q2, q3) + u x d_0, d_0 from the highest power of e_0 that is left to the lowest
// This is 0 only if u = 0. Then D = 0 for all d_0 and d_1, and with A = q0 - q3, B = q1 - q3:
//   the part linear in d_2: -((A + d_0) x (B + d_1)) . d_2; its first component is not 0, since it contains the term
//   e_0^2 e_1^3 alone with its powers.
// So no sign is 0, and all signs describe one surface, as near to the given one as one likes. In it no vertex lies in
// the plane of a facet that does not contain it, no edges without a common vertex meet, facets with a common edge meet
// in this edge alone, and facets with one common vertex meet there alone or in a segment that ends there.
#pragma once

#include <cstdint>
#include <utility>

#include "geometry/exact_predicates.hpp"

namespace morula::detail {

/// A point and the index that tells its translation.
struct IndexedPoint {
  Vec3 at;
  std::uint32_t index;
};

/// orient3d() of four points with different indices, in general position: 1 or -1.
int perturbed_orient3d(const IndexedPoint& a, const IndexedPoint& b, const IndexedPoint& c, const IndexedPoint& d);

/// The sign where orient3d() is 0.
int perturbation_orient3d(const IndexedPoint& a, const IndexedPoint& b, const IndexedPoint& c, const IndexedPoint& d);

}  // namespace morula::detail
