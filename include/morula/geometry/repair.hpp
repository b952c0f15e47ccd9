// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Repairs of a mesh: vertices merged, facets without area removed, orientation made consistent, small holes capped.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <optional>
#include <vector>

namespace morula {

struct RepairOptions {
  /// Vertices at most this far apart become one, mesh units: 0 merges equal positions alone, nothing merges none. A
  /// vertex goes to the first one within reach that stays, so chains of vertices do not collapse.
  std::optional<double> merge_distance = 0.0;
  /// Remove facets with a repeated vertex or an area below 1e-12 × diagonal². This may open a closed mesh: where
  /// three vertices lie on a line, the facet between them is all that joins its neighbors.
  bool remove_degenerate = false;
  /// Turn facets so that neighbors agree about which side is out, as few as possible, then closed pieces so that the
  /// outermost ones face outwards; what they contain is turned along, so that cavities stay cavities.
  bool orient = true;
  /// Close holes of at most so many edges, without new vertices; 0: none. Least area; a hole that can only be closed by
  /// an edge that is there already stays.
  std::size_t cap_edges = 0;  ///< at most 500
};

struct RepairReport {
  std::size_t merged_vertices = 0;
  std::size_t collapsed_facets = 0;     ///< of which merging left two corners or one: removed
  std::size_t degenerate_facets = 0;    ///< removed on request
  std::size_t turned_facets = 0;        ///< as written against as read
  std::size_t unorientable_pieces = 0;  ///< such as a Moebius strip: left as they were
  std::size_t capped_holes = 0;
  std::size_t cap_facets = 0;  ///< the last ones of the mesh
  std::size_t open_holes = 0;  ///< loops of border edges that are left
  /// The new number of each old vertex: for motions, which are positions in the order of vertices.
  std::vector<std::uint32_t> new_vertex;

  bool changed() const {
    return merged_vertices + collapsed_facets + degenerate_facets + turned_facets + capped_holes > 0;
  }
};

struct RepairedMesh {
  Mesh mesh;
  RepairReport report;
};

/// Kept: the order of vertices and facets that stay, and vertices of no facet. Positions are never moved. The same bits
/// everywhere. Cost: O(F log F), and the cube of a hole's edges for each cap.
///
/// Throws std::invalid_argument for indices out of range, coordinates of used vertices that are not finite, a distance
/// that is negative or not finite, and caps of more than 500 edges.
RepairedMesh repair(const MeshView& mesh, const RepairOptions& options = {});

/// A mesh without the vertices that no facet uses, such as the inner points of a solid.
struct UsedVertices {
  Mesh mesh;
  std::vector<std::uint32_t> index;  ///< of every vertex of `mesh`: its number before, ascending
};
/// Vertices keep their order and facets theirs.
UsedVertices used_vertices(const MeshView& mesh);

}  // namespace morula
