// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A triangle mesh: positions and triangles, nothing else. The vertex order is that of the file; motions refer to it.
#pragma once

#include <array>
#include <cstddef>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/vector.hpp>
#include <vector>

namespace morula {

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Facet> facets;

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t facet_count() const { return facets.size(); }
  std::array<Vec3, 3> corners(std::size_t facet) const {
    const Facet& f = facets[facet];
    return {positions[f[0]], positions[f[1]], positions[f[2]]};
  }
};

/// A copy of the arrays that a view borrows.
Mesh to_mesh(const MeshView& view);

inline MeshView::MeshView(const Mesh& mesh) : positions(mesh.positions), facets(mesh.facets) {}

}  // namespace morula
