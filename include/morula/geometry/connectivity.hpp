// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Connectivity: edges, neighbors, fans, components and borders of a surface. They depend on the facets alone, so no
// deformation changes them.
//
//   const morula::Connectivity surface = morula::connectivity(mesh);
//   for (const std::uint32_t edge : morula::border_edges(surface))
//     std::printf("the edge from vertex %u to %u has one facet\n", surface.edges[edge][0], surface.edges[edge][1]);
//   const std::uint32_t neighbor = surface.facet_across(0, 1);  // across the second side of facet 0
//   const morula::Components parts = morula::components_by_edges(mesh, surface);
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/mesh_view.hpp>
#include <span>
#include <vector>

namespace morula {

inline constexpr std::uint32_t no_edge = 0xffffffffu;
/// Values of facet_across() for a side without exactly one neighbor: no facet, or more than one.
inline constexpr std::uint32_t no_facet = 0xffffffffu, several_facets = 0xfffffffeu;

/// Side 3 f + k runs along facet f from its corner k to the next corner. An edge is the set of sides between two
/// vertices, in either direction. Facets with a repeated index have no sides and belong to no fan.
struct Connectivity {
  std::vector<std::array<std::uint32_t, 2>> edges;  ///< vertices of each edge, lower index first; ascending
  std::vector<std::uint32_t> side_begin;            ///< edge e has sides [side_begin[e], side_begin[e + 1])
  std::vector<std::uint32_t> sides;                 ///< sides of all edges, ascending within an edge
  /// Edges of sides 3 f, 3 f + 1, 3 f + 2; no_edge for a facet without sides.
  std::vector<std::array<std::uint32_t, 3>> facet_edges;
  std::vector<std::uint32_t> fan_begin;   ///< vertex v has facets [fan_begin[v], fan_begin[v + 1]) of fan_facets
  std::vector<std::uint32_t> fan_facets;  ///< facets of all vertices, ascending within a vertex

  std::size_t edge_count() const { return edges.size(); }
  std::span<const std::uint32_t> edge_sides(std::uint32_t edge) const {
    return std::span(sides).subspan(side_begin[edge], side_begin[edge + 1] - side_begin[edge]);
  }
  std::span<const std::uint32_t> vertex_facets(std::uint32_t vertex) const {
    return std::span(fan_facets).subspan(fan_begin[vertex], fan_begin[vertex + 1] - fan_begin[vertex]);
  }
  /// The facet on the other side of side 3 facet + k; no_facet at a border, several_facets if more than two facets
  /// share the edge.
  std::uint32_t facet_across(std::uint32_t facet, std::uint32_t k) const;
};

/// Computes the connectivity. All indices of the mesh's facets must be in range. Cost: O(F log valence).
Connectivity connectivity(const MeshView& mesh);

/// The first and the last vertex of a side.
inline std::array<std::uint32_t, 2> side_ends(std::span<const Facet> facets, std::uint32_t side) {
  const Facet& f = facets[side / 3];
  return {f[side % 3], f[(side + 1) % 3]};
}

/// Connected components of a surface, numbered in the order of their lowest facets.
struct Components {
  std::vector<std::uint32_t> of_facet;
  std::uint32_t count = 0;
};
/// Facets that share a vertex belong to one component. Facets with a repeated index count like all others.
Components components_by_vertices(const MeshView& mesh);
/// Facets that share an edge belong to one component; facets that only touch at a vertex do not. A facet without sides
/// is a component of its own.
Components components_by_edges(const MeshView& mesh, const Connectivity& connectivity);

/// Edges with one side; edges with more than two sides. Both ascending.
std::vector<std::uint32_t> border_edges(const Connectivity& connectivity);
std::vector<std::uint32_t> nonmanifold_edges(const Connectivity& connectivity);
/// Vertices whose facets form more than one fan, ascending. A fan is a set of facets around the vertex that are
/// connected by edges at the vertex.
std::vector<std::uint32_t> nonmanifold_vertices(const MeshView& mesh, const Connectivity& connectivity);

/// Chains of border sides: each side starts at the end of the side before it.
struct BorderLoops {
  std::vector<std::uint32_t> begin;   ///< chain i is sides [begin[i], begin[i + 1])
  std::vector<std::uint32_t> sides;   ///< every side of a border edge, once
  std::vector<std::uint8_t> is_loop;  ///< 1 if the last side of the chain ends where the first starts

  std::size_t count() const { return is_loop.size(); }
  std::span<const std::uint32_t> run(std::size_t i) const {
    return std::span(sides).subspan(begin[i], begin[i + 1] - begin[i]);
  }
};
/// Computes the chains. No chain visits a vertex twice. If the surface is oriented and has no non-manifold edges, all
/// chains are loops, and the surface lies to their left, seen from outside. Cost: linear.
BorderLoops border_loops(const MeshView& mesh, const Connectivity& connectivity);

}  // namespace morula
