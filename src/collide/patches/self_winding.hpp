// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The winding number of a closed surface just outside one of its own edges, in general position (self_predicates.hpp).
//
// It is 0 at a point X outside all spheres. On the segment from a vertex v to X, each facet that does not contain v
// changes it where the segment passes through. Near v, the facets that contain v but not a vertex u are cones; they
// change it on the way from the direction of X to that of u, in the triangle v u X, where they meet this triangle's
// cone. So it is known in this triangle, next to the edge v u. There it is the number outside the edge, or one more if
// the triangle lies inside the wedge of the edge's two facets.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <span>
#include <vector>

#include "collide/patches/closed_surface.hpp"
#include "collide/patches/self_predicates.hpp"

namespace morula::detail {

class SelfWinding {
 public:
  /// world: positions of all vertices. Cost: see InsideQuery::locate.
  int outside(const Collider& body, const ClosedSurface& surface, std::span<const Vec3> world, std::uint32_t edge);

 private:
  void collect(const Collider& body, const Vec3& from, int axis, int sign);
  std::vector<std::uint32_t> facets_;
};

}  // namespace morula::detail
