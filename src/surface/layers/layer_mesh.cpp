// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/layers/layer_mesh.hpp"

#include <algorithm>

namespace morula::detail {

void LayerMesh::start(const SurfaceTreeState& surface) {
  if (is_of(surface)) return;
  surface_ = nullptr;
  const SurfaceMesh& mesh = surface.mesh;
  const auto number_of = [&](std::uint32_t v, std::uint32_t w) {
    const std::array<std::uint32_t, 2> ends{std::min(v, w), std::max(v, w)};
    return static_cast<std::uint32_t>(std::lower_bound(mesh.edges.begin(), mesh.edges.end(), ends) -
                                      mesh.edges.begin());
  };
  edges_.assign(mesh.facets.size(), {none, none, none});
  facets_begin_.assign(mesh.edges.size() + 1, 0);
  rest_area_.assign(mesh.edges.size(), 0.0);
  for (std::size_t i = 0; i < mesh.facets.size(); ++i) {
    const Facet& f = mesh.facets[i];
    if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) continue;
    const double third = area({mesh.rest[f[0]], mesh.rest[f[1]], mesh.rest[f[2]]}) / 3;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t edge = edges_[i][k] = number_of(f[k], f[(k + 1) % 3]);
      ++facets_begin_[edge + 1];
      rest_area_[edge] += third;
    }
  }
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) facets_begin_[e + 1] += facets_begin_[e];
  facets_.resize(facets_begin_.back());
  std::vector<std::uint32_t> next(facets_begin_.begin(), facets_begin_.end() - 1);
  for (std::uint32_t i = 0; i < mesh.facets.size(); ++i)
    if (is_usable(i))
      for (const std::uint32_t edge : edges_[i]) facets_[next[edge]++] = i;
  at_.assign(mesh.rest.size(), {});
  surface_ = &surface;
  kept_ = surface.weak_from_this().lock();
}

LayerNormal::LayerNormal(const Triangle& t) {
  double largest = -1;
  for (int k = 0; k < 3; ++k) {
    const double squared = squared_distance(t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>((k + 1) % 3)]);
    if (squared > largest) largest = squared, longest = k;
  }
  const Vec3 vector = area_vector(t);
  const double size = length(vector);
  // mutant layers-sliver: `1e-8` -> `0`
  if (!(size > 1e-8 * largest)) return;
  normal = vector / size;
  double_area = size;
}

}  // namespace morula::detail
