// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The winding number of a closed surface just outside one of its own edges, in general position (self_predicates.hpp).
//
// It is 0 at a point X outside the box of all facets. On the segment from a vertex v to X, each facet that does not
// contain v changes it where the segment passes through. Near v, the facets that contain v but not a vertex u are
// cones; they change it on the way from the direction of X to that of u, in the triangle v u X, where they meet this
// triangle's cone. So it is known in this triangle, next to the edge v u. There it is the number outside the edge, or
// one more if the triangle lies inside the wedge of the edge's two facets.
#pragma once

#include <cstdint>
#include <morula/geometry/connectivity.hpp>
#include <span>

#include "collide/patches/self_predicates.hpp"
#include "collide/patches/self_tree.hpp"

namespace morula::detail {

/// facets, world: of the surface; tree: over them. Cost: about that of InsideQuery::locate.
int number_outside(std::span<const Facet> facets, const Connectivity& connectivity, const SelfTree& tree,
                   std::span<const Vec3> world, std::uint32_t edge);

}  // namespace morula::detail
