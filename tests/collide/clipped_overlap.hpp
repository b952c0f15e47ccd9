// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The overlap of two solid bodies by other means: cones over the facets, as signed tetrahedra, clipped by each other in
// long double.
#pragma once

#include <morula/collide/collider.hpp>

namespace morula::test {

struct ClippedOverlap {
  double volume = 0;
  Vec3 centroid;
  Vec3 area_vector_a, area_vector_b;  ///< of a's surface inside b, and of b's inside a
};

/// Cost: the product of the numbers of facets, about a microsecond each.
ClippedOverlap clipped_overlap(const Collider& a, const Collider& b);

}  // namespace morula::test
