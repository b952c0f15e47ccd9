// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A triangle mesh: positions and triangles, nothing else. Vertex order is the file's; motions refer to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <morula/geometry/box.hpp>
#include <morula/geometry/vector.hpp>
#include <span>
#include <string_view>
#include <vector>

namespace morula {

/// Vertex indices of one facet, counter-clockwise seen from outside.
using Facet = std::array<std::uint32_t, 3>;

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

/// Throws std::invalid_argument, naming the first offender, unless the mesh has at least one facet, all indices are in
/// range and all positions used by facets are finite. Every function that takes a mesh may assume it passed.
void require_usable(const Mesh& mesh);

/// Box of the vertices that facets use (unused vertices are not part of the surface).
Box bounding_box(const Mesh& mesh);
double surface_area(const Mesh& mesh);
/// Σ signed tetrahedra about the box centre: the enclosed volume when the mesh is closed and oriented outward.
double signed_volume(const Mesh& mesh);
/// 64-bit FNV-1a over positions and facets, byte order fixed: equal meshes, equal hashes.
std::uint64_t mesh_hash(const Mesh& mesh);

}  // namespace morula
