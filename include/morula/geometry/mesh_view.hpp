// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A view of a mesh that the caller owns: positions in any layout, facets, no copy. Functions that only read a mesh take
// a view.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/geometry/positions.hpp>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula {

/// Vertex indices of one facet, counter-clockwise seen from outside.
using Facet = std::array<std::uint32_t, 3>;

struct Mesh;

/// A mesh view is cheap to copy. Positions and facets must stay in place while the view is used: the view of a
/// temporary mesh, as in `inspect(read_mesh(path))`, ends with the call.
struct MeshView {
  PositionView positions;  ///< one position per vertex, float or double, at rest or deformed
  std::span<const Facet> facets;

  MeshView(const Mesh& mesh);
  MeshView(const PositionView& positions_of, std::span<const Facet> facets_of)
      : positions(positions_of), facets(facets_of) {}

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t facet_count() const { return facets.size(); }
  std::array<Vec3, 3> corners(std::size_t facet) const {
    const Facet& f = facets[facet];
    return {positions[f[0]], positions[f[1]], positions[f[2]]};
  }
};

/// Throws std::invalid_argument, naming the first offender, unless the mesh has at least one facet, all indices are in
/// range, and all positions used by facets are finite. Every function that takes a mesh may assume this.
void require_usable(const MeshView& mesh);

/// Box of the vertices that facets use; unused vertices are not part of the surface.
Box bounding_box(const MeshView& mesh);
/// The largest |coordinate| of the vertices that facets use; 0 without facets. Ranges and pads are relative to it.
double largest_coordinate(const MeshView& mesh);
/// The largest |coordinate| of all points of a box that is not empty.
inline double largest_coordinate(const Box& box) {
  return std::max(max_norm(box.lower), max_norm(box.upper));
}
double surface_area(const MeshView& mesh);
/// Sum of the signed tetrahedra about the box center: the enclosed volume if the mesh is closed and oriented outward.
double signed_volume(const MeshView& mesh);
/// 64-bit FNV-1a over positions and facets, with a fixed byte order: equal meshes have equal hashes.
std::uint64_t mesh_hash(const MeshView& mesh);

}  // namespace morula
