// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surface of solids in memory: the outer facets of a volume mesh, such as that of a finite-element solver.
//
//   const morula::UsedVertices surface = morula::solid_surface(points, tetrahedra);
//   morula::Body organ(surface.mesh, morula::build(surface.mesh));
//   const auto view = morula::PositionView::indexed(points, surface.index);  // vertex i is points[surface.index[i]]
//   if (!organ.update(view)) return;                                         // whenever the solver moves its points
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/positions.hpp>
#include <morula/geometry/repair.hpp>
#include <span>

namespace morula {

/// Corners of a tetrahedron: indices of points. Both orientations are accepted.
using Tetrahedron = std::array<std::uint32_t, 4>;
/// Corners of a hexahedron: indices of points, the lower face around, then the upper face around in the same direction,
/// as VTK and Gmsh order them. Both orientations are accepted.
using Hexahedron = std::array<std::uint32_t, 8>;

/// The surface of solids that share whole faces: the faces that only one solid has, counter-clockwise seen from
/// outside, in the order of the solids, tetrahedra first. A face of four corners is cut into two facets. The vertices
/// of `mesh` are the points that these facets use, in the order of the points; `index` has their numbers among the
/// points.
///
/// points: positions at rest, mesh units. Points of no solid are allowed. A tetrahedron and a hexahedron share no face:
/// where they meet, the surface has the faces of both.
///
/// Throws std::invalid_argument, naming the first offender and its number from 0: no solids; an index out of range; a
/// solid with a repeated corner; a corner that is not finite; a tetrahedron whose corners lie in one plane (exact), or
/// a hexahedron whose volume is computed as 0; a face that more than two solids share; two solids on the same side of a
/// common face, such as a repeated solid. Does not find other overlaps. The result has the same bits on all machines.
/// Cost: O(n log n) for n solids.
UsedVertices solid_surface(const PositionView& points, std::span<const Tetrahedron> tetrahedra,
                           std::span<const Hexahedron> hexahedra = {});

}  // namespace morula
