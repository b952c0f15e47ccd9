// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Mesh report: counts, closedness, orientation, volume.
#pragma once

#include <morula/geometry/connectivity.hpp>
#include <morula/geometry/mesh.hpp>

namespace morula {

/// Facets with a repeated index are counted as degenerate and otherwise ignored: they have no edges.
struct [[nodiscard]] MeshReport {
  std::size_t vertex_count = 0;
  std::size_t facet_count = 0;
  std::size_t component_count = 0;       ///< pieces of surface connected by shared vertices
  std::size_t boundary_edges = 0;        ///< edges of exactly one facet
  std::size_t nonmanifold_edges = 0;     ///< edges of more than two facets
  std::size_t misoriented_edges = 0;     ///< edges of two facets that traverse it in the same direction
  std::size_t nonmanifold_vertices = 0;  ///< vertices whose facets form more than one fan
  std::size_t degenerate_facets = 0;     ///< repeated index, or area below 1e-12 × diagonal²
  std::size_t duplicate_facets = 0;      ///< facets with the same three vertices as an earlier one
  std::size_t duplicate_vertices = 0;    ///< vertices at exactly the position of an earlier one, used or not
  std::size_t unused_vertices = 0;       ///< vertices of no facet
  bool closed = false;                   ///< every edge has an even number of facets
  /// Facets that share an edge agree about which side is out: every edge is traversed equally often in both directions,
  /// one facet left over where their number is odd. So an open mesh can be oriented, a Moebius strip cannot.
  bool oriented = false;
  bool manifold = false;  ///< no non-manifold edge or vertex
  Box box;
  double area = 0;
  double volume = 0;  ///< signed; meaningful only when has_volume()

  /// Inside and outside are well defined: closed and consistently oriented.
  bool has_volume() const { return closed && oriented; }
};

/// Cost: O(F log F), about a second for a million facets.
MeshReport inspect(const MeshView& mesh);
/// The same, when the connectivity is there already.
MeshReport inspect(const MeshView& mesh, const Connectivity& connectivity);

}  // namespace morula
