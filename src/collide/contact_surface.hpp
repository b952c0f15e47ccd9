// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The facet of a node's region nearest to a point.
#pragma once

#include <cstdint>
#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/surface_point.hpp>

namespace morula {

struct SurfaceScratch {};

/// Looks at every facet of the node; to be replaced by a search that knows the regions. Ties: the facet that comes
/// first in collider.facets(node).
inline SurfacePoint nearest_facet(const Collider& collider, std::uint32_t node, const Vec3& world_point,
                                  SurfaceScratch&) {
  SurfacePoint nearest{};
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t facet : collider.facets(node)) {
    const TrianglePoint found = closest_point(collider.triangle(facet), world_point);
    if (!(found.squared_distance < least)) continue;
    least = found.squared_distance;
    nearest = {facet, found.barycentric, found.point};
  }
  return nearest;
}

}  // namespace morula
