// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A triangle mesh: the positions of its vertices, and its facets, each by the numbers of three vertices. Vertices have
// the order of the mesh's file, and so have the positions of a motion.
#pragma once

#include <array>
#include <cstddef>
#include <morula/geometry/mesh_view.hpp>
#include <morula/geometry/vector.hpp>
#include <vector>

namespace morula {

/// A triangle mesh that owns its arrays. require_usable() checks it.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Facet> facets;

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t facet_count() const { return facets.size(); }
  /// The positions of the three vertices of a facet.
  std::array<Vec3, 3> corners(std::size_t facet) const {
    const Facet& f = facets[facet];
    return {positions[f[0]], positions[f[1]], positions[f[2]]};
  }
};

/// A mesh with copies of the arrays that a view borrows.
Mesh to_mesh(const MeshView& view);

inline MeshView::MeshView(const Mesh& mesh) : positions(mesh.positions), facets(mesh.facets) {}

}  // namespace morula
