// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Connectivity: edges, neighbors, fans, pieces and borders of a surface. They hang on the facets alone, so no
// deformation changes them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/mesh_view.hpp>
#include <span>
#include <vector>

namespace morula {

inline constexpr std::uint32_t no_edge = 0xffffffffu;
/// What is across a side: nothing, or more than one facet.
inline constexpr std::uint32_t no_facet = 0xffffffffu, several_facets = 0xfffffffeu;

/// Side 3 f + k is facet f's way from its corner k to the next. An edge is what sides between the same two vertices
/// have in common, whichever way they go. Facets with a repeated index have no sides and are in no fan.
struct Connectivity {
  std::vector<std::array<std::uint32_t, 2>> edges;        ///< lower vertex first; ascending
  std::vector<std::uint32_t> side_begin;                  ///< edge e has sides [side_begin[e], side_begin[e + 1])
  std::vector<std::uint32_t> sides;                       ///< ascending within an edge
  std::vector<std::array<std::uint32_t, 3>> facet_edges;  ///< of sides 3 f, 3 f + 1, 3 f + 2; no_edge without sides
  std::vector<std::uint32_t> fan_begin;                   ///< vertex v is in facets [fan_begin[v], fan_begin[v + 1])
  std::vector<std::uint32_t> fan_facets;                  ///< ascending within a vertex

  std::size_t edge_count() const { return edges.size(); }
  std::span<const std::uint32_t> edge_sides(std::uint32_t edge) const {
    return std::span(sides).subspan(side_begin[edge], side_begin[edge + 1] - side_begin[edge]);
  }
  std::span<const std::uint32_t> vertex_facets(std::uint32_t vertex) const {
    return std::span(fan_facets).subspan(fan_begin[vertex], fan_begin[vertex + 1] - fan_begin[vertex]);
  }
  /// The facet on the other side of side 3 facet + k; no_facet at a border, several_facets where more than two meet.
  std::uint32_t facet_across(std::uint32_t facet, std::uint32_t k) const;
};

/// All indices of the mesh's facets must be in range. Cost: O(F log valence).
Connectivity connectivity(const MeshView& mesh);

/// The vertex where a side starts and the one where it ends.
inline std::array<std::uint32_t, 2> side_ends(std::span<const Facet> facets, std::uint32_t side) {
  const Facet& f = facets[side / 3];
  return {f[side % 3], f[(side + 1) % 3]};
}

/// Pieces of surface, numbered in the order of their lowest facets.
struct Components {
  std::vector<std::uint32_t> of_facet;
  std::uint32_t count = 0;
};
/// Facets that share a vertex are of one piece. Facets with a repeated index count as any other.
Components components_by_vertices(const MeshView& mesh);
/// Facets that share an edge are of one piece: two that only touch at a vertex are not. A facet without sides is a
/// piece of its own.
Components components_by_edges(const MeshView& mesh, const Connectivity& connectivity);

/// Edges of one side; edges of more than two. Ascending.
std::vector<std::uint32_t> border_edges(const Connectivity& connectivity);
std::vector<std::uint32_t> nonmanifold_edges(const Connectivity& connectivity);
/// Vertices whose facets form more than one fan: some two of them are not connected by facets around the vertex that
/// share edges there. Ascending.
std::vector<std::uint32_t> nonmanifold_vertices(const MeshView& mesh, const Connectivity& connectivity);

/// Border sides in runs: each side starts where the one before it ends.
struct BorderLoops {
  std::vector<std::uint32_t> begin;   ///< run i is sides [begin[i], begin[i + 1])
  std::vector<std::uint32_t> sides;   ///< every side of a border edge, once
  std::vector<std::uint8_t> is_loop;  ///< the last side ends where the first starts

  std::size_t count() const { return is_loop.size(); }
  std::span<const std::uint32_t> run(std::size_t i) const {
    return std::span(sides).subspan(begin[i], begin[i + 1] - begin[i]);
  }
};
/// No run goes through a vertex twice. On a surface whose facets agree about which side is out, and without
/// non-manifold edges, all runs are loops; the surface is on their left, seen from outside. Cost: linear.
BorderLoops border_loops(const MeshView& mesh, const Connectivity& connectivity);

}  // namespace morula
