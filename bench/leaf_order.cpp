// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "leaf_order.hpp"

namespace morula::bench {

Mesh in_leaf_order(const Mesh& mesh, Built& built) {
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<std::uint32_t> number(mesh.vertex_count(), none);
  std::uint32_t next = 0;
  // Patches are in the order of the leaves, depth first.
  for (const std::uint32_t corner : built.cover.corners)
    if (corner < mesh.vertex_count() && number[corner] == none) number[corner] = next++;
  for (std::uint32_t& n : number)
    if (n == none) n = next++;

  Mesh ordered = mesh;
  for (std::size_t v = 0; v < number.size(); ++v) ordered.positions[number[v]] = mesh.positions[v];
  for (Facet& f : ordered.facets)
    for (std::uint32_t& v : f) v = number[v];
  for (std::uint32_t& corner : built.cover.corners)
    if (corner < mesh.vertex_count()) corner = number[corner];
  for (CutPoint& c : built.cover.cut_points)
    for (std::uint32_t& v : c.vertex) v = number[v];
  built.report.mesh_hash = mesh_hash(ordered);
  return ordered;
}

}  // namespace morula::bench
