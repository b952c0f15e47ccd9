// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/link.hpp"

#include <algorithm>

namespace morula::detail {
namespace {

std::vector<std::uint32_t> vertices_of(const Mesh& mesh, const std::vector<std::uint32_t>& facets) {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(3 * facets.size());
  for (const std::uint32_t f : facets) vertices.insert(vertices.end(), mesh.facets[f].begin(), mesh.facets[f].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

Links linked_vertices(const Mesh& mesh, const TriangleBvh& bvh, const Sphere& ball) {
  std::vector<std::uint32_t> facets;
  bvh.facets_touching(ball, facets);
  if (!facets.empty()) return {vertices_of(mesh, facets), false};
  return {vertices_of(mesh, {bvh.closest_point(ball.center)->facet}), true};
}

Links enclosed_vertices(const Mesh& mesh, const TriangleBvh& bvh, const SphereTree& tree, std::uint32_t node) {
  bool fallback = false;
  std::vector<std::uint32_t> facets;
  for (;;) {
    const Sphere& ball = tree.spheres[node];
    // A vertex inside the ball is part of a facet that meets it.
    bvh.facets_touching(ball, facets);
    std::vector<std::uint32_t> vertices = vertices_of(mesh, facets);
    std::erase_if(vertices,
                  [&](std::uint32_t v) { return !(distance(mesh.positions[v], ball.center) <= ball.radius); });
    if (!vertices.empty()) return {std::move(vertices), fallback};
    fallback = true;
    if (!facets.empty() || tree.parent[node] == no_node)
      return {vertices_of(mesh, {bvh.closest_point(ball.center)->facet}), fallback};
    node = tree.parent[node];
  }
}

std::vector<double> vertex_areas(const Mesh& mesh) {
  std::vector<double> areas(mesh.vertex_count());
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const double third = area(mesh.corners(f)) / 3;
    for (const std::uint32_t v : mesh.facets[f]) areas[v] += third;
  }
  return areas;
}

}  // namespace morula::detail
