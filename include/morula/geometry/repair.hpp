// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Repairs of a mesh: merged vertices, removed degenerate facets, a consistent orientation, caps for small holes.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula {

struct RepairOptions {
  /// Largest distance of vertices that are merged, mesh units; 0 merges equal positions only, no value merges none. A
  /// vertex is merged into the first remaining vertex within the distance, so chains of vertices do not collapse.
  std::optional<double> merge_distance = 0.0;
  /// Remove facets with a repeated vertex or an area below 1e-12 × diagonal². This may open a closed mesh: if three
  /// vertices lie on a line, only the facet between them joins its neighbors.
  bool remove_degenerate = false;
  /// Orient facets consistently, flipping as few as possible; then orient closed components so that the outermost ones
  /// face outward. The components inside a component are flipped with it, so cavities stay cavities.
  bool orient = true;
  /// Largest number of edges of the holes to close, without new vertices; 0 closes none. Caps have the least area. A
  /// hole stays open if every cap needs an edge that exists already.
  std::size_t cap_edges = 0;  ///< at most 500
  /// A number per vertex; only vertices with the same number are merged. skin_labels() keeps vertices apart that a skin
  /// may move apart. Empty: positions decide alone.
  std::span<const std::uint32_t> labels{};
};

struct RepairReport {
  std::size_t merged_vertices = 0;
  std::size_t collapsed_facets = 0;     ///< facets with two corners or one after merging; removed
  std::size_t degenerate_facets = 0;    ///< facets removed by remove_degenerate
  std::size_t turned_facets = 0;        ///< facets written in the opposite direction
  std::size_t unorientable_pieces = 0;  ///< components without an orientation, such as a Moebius strip; unchanged
  std::size_t capped_holes = 0;
  std::size_t cap_facets = 0;  ///< facets of the caps, the last ones of the mesh
  std::size_t open_holes = 0;  ///< remaining loops of border edges
  /// The new number of each old vertex, to renumber motions, which list positions in vertex order.
  std::vector<std::uint32_t> new_vertex;
  /// For each new vertex the first old one that becomes it, to renumber skins by skin_of_vertices(); ascending.
  std::vector<std::uint32_t> old_vertex;

  bool changed() const {
    return merged_vertices + collapsed_facets + degenerate_facets + turned_facets + capped_holes > 0;
  }
};

struct RepairedMesh {
  Mesh mesh;
  RepairReport report;
};

/// Repairs a mesh. Remaining vertices and facets keep their order; vertices of no facet are kept. No position moves.
/// The result has the same bits on all machines. Cost: O(F log F), and for each cap the cube of the hole's edges.
///
/// Throws std::invalid_argument for indices out of range, coordinates of used vertices that are not finite, a distance
/// that is negative or not finite, caps of more than 500 edges, and another number of labels than vertices.
RepairedMesh repair(const MeshView& mesh, const RepairOptions& options = {});

/// A mesh without the vertices that no facet uses, such as the inner points of a solid.
struct UsedVertices {
  Mesh mesh;
  std::vector<std::uint32_t> index;  ///< number of every vertex of `mesh` in the given mesh, ascending
};
/// Removes unused vertices. Vertices and facets keep their order.
UsedVertices used_vertices(const MeshView& mesh);

}  // namespace morula
