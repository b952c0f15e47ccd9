// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Welding: vertices at one position become one, so that facets that only touch share vertices.
//
//   const morula::MeshWeld weld = morula::weld_vertices(mesh);
//   const morula::Mesh whole = morula::welded(mesh, weld);
//   std::printf("%zu vertices merged\n", weld.merged_count());
//   // Every frame, with positions of the given mesh; the body borrows the welded ones until its next update.
//   const std::vector<morula::Vec3> whole_positions = morula::welded_positions(positions, weld);
//   body.update(whole_positions);
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <span>
#include <vector>

namespace morula {

/// Map of the vertices of a mesh to those of its welded mesh. Each vertex is merged into the first equal one.
struct MeshWeld {
  std::vector<std::uint32_t> new_vertex;  ///< number in the welded mesh, for each vertex of the given mesh
  /// For each vertex of the welded mesh the first vertex of the given mesh that becomes it; ascending.
  std::vector<std::uint32_t> old_vertex;
  /// Number of vertices of the welded mesh at the position of an earlier one: their labels differ, so they may move
  /// apart.
  std::size_t kept_apart = 0;

  /// Number of merged vertices: those of the given mesh minus those of the welded one.
  std::size_t merged_count() const { return new_vertex.size() - old_vertex.size(); }
};

/// Finds vertices with equal positions and equal labels; 0 and -0 are equal, and there is no tolerance. A vertex that
/// is not finite is equal to none. labels: a number per vertex that stands for all that moves it, such as
/// skin_labels(); empty: positions decide alone. Throws std::invalid_argument for another number of labels. Cost:
/// linear.
MeshWeld weld_vertices(const MeshView& mesh, std::span<const std::uint32_t> labels = {});

/// The mesh with merged vertices. Facets keep their order and their number; a facet of which two corners are merged has
/// a repeated vertex, and repair() removes it. Throws std::invalid_argument for a weld of another number of vertices.
Mesh welded(const MeshView& mesh, const MeshWeld& weld);
/// Positions of the welded mesh from positions of the given mesh: those of the first of merged vertices. Throws
/// std::invalid_argument for another number of positions.
std::vector<Vec3> welded_positions(const PositionView& positions, const MeshWeld& weld);

}  // namespace morula
