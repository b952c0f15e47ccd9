// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Mesh report: counts, closedness, orientation, volume.
//
//   const morula::MeshReport report = morula::inspect(mesh);
//   std::printf("%zu components, area %g\n", report.component_count, report.area);
//   if (!report.closed) std::printf("%zu edges have one facet\n", report.boundary_edges);
//   if (!report.manifold) std::printf("%zu edges have more than two facets\n", report.nonmanifold_edges);
//   if (report.has_volume()) std::printf("volume %g\n", report.volume);
#pragma once

#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/mesh.hpp>

namespace morula {

struct MeshReport;

/// Counts the parts and the defects of a mesh, and measures its area and volume. require_usable() must accept the mesh.
/// Cost: O(F log F) for F facets, about a second for a million.
MeshReport inspect(const MeshView& mesh);
/// The same for a caller that already has the connectivity of the mesh.
MeshReport inspect(const MeshView& mesh, const Connectivity& connectivity);

/// The result of inspect(). Facets with a repeated index have no edges, so the counts of edges, of fans and what
/// follows from them ignore these facets. They count as degenerate, and like other facets in all other counts.
struct [[nodiscard]] MeshReport {
  std::size_t vertex_count = 0;
  std::size_t facet_count = 0;
  std::size_t component_count = 0;       ///< components of the surface, connected by shared vertices
  std::size_t boundary_edges = 0;        ///< edges of exactly one facet
  std::size_t nonmanifold_edges = 0;     ///< edges of more than two facets
  std::size_t misoriented_edges = 0;     ///< edges of two facets that traverse it in the same direction
  std::size_t nonmanifold_vertices = 0;  ///< vertices whose facets form more than one fan
  std::size_t degenerate_facets = 0;     ///< facets with a repeated index or an area below 1e-12 × diagonal²
  std::size_t duplicate_facets = 0;      ///< facets with the same three vertices as an earlier one
  std::size_t duplicate_vertices = 0;    ///< vertices at exactly the position of an earlier vertex, used or not
  std::size_t unused_vertices = 0;       ///< vertices of no facet
  bool closed = false;                   ///< there are edges, and every edge has an even number of facets
  /// Facets that share an edge agree on the outer side: every edge is traversed equally often in both directions,
  /// except for one facet if their number is odd. An open mesh can be oriented; a Moebius strip cannot.
  bool oriented = false;
  bool manifold = false;  ///< no non-manifold edge or vertex
  Box box;
  double area = 0;
  double volume = 0;  ///< signed volume, mesh units³; meaningful only if has_volume()

  /// The mesh is closed and oriented, so inside and outside are well defined. False for a mesh without edges.
  bool has_volume() const { return closed && oriented; }
};

}  // namespace morula
