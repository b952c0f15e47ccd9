// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/used_vertices.hpp>

namespace morula {

UsedVertices used_vertices(const Mesh& mesh) {
  std::vector<std::uint32_t> place(mesh.vertex_count(), 0);
  for (const Facet& facet : mesh.facets) {
    for (const std::uint32_t v : facet) place[v] = 1;
  }
  UsedVertices used;
  for (std::size_t v = 0; v < place.size(); ++v) {
    if (place[v] == 0) continue;
    place[v] = static_cast<std::uint32_t>(used.index.size());
    used.index.push_back(static_cast<std::uint32_t>(v));
    used.mesh.positions.push_back(mesh.positions[v]);
  }
  for (const Facet& facet : mesh.facets)
    used.mesh.facets.push_back({place[facet[0]], place[facet[1]], place[facet[2]]});
  return used;
}

}  // namespace morula
