// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Volumes of layers from all edges against all facets, by sums of many points: no tree, no index, no closed formula.
#pragma once

#include <functional>
#include <morula/geometry/mesh.hpp>
#include <set>
#include <utility>
#include <vector>

namespace morula::test {

/// Whether facet i of a acts on facet j of b.
using LayerRule = std::function<bool(std::uint32_t, std::uint32_t)>;
inline bool all_act(std::uint32_t, std::uint32_t) {
  return true;
}

/// The integral over a's edges of the sum over facets, edges and vertices of b with the coefficients of
/// LayerPatchQuery's definition, at `points` places of every edge, which counts with a third of the rest area of its
/// facets.
double plain_layer(const Mesh& rest_a, const std::vector<Vec3>& a, const Mesh& mesh_b, const std::vector<Vec3>& b,
                   double thickness, int points, const LayerRule& acts = all_act);

/// The pairs of facets that are nearer to each other than the thickness and act on each other, in connected groups.
using FacetPairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;
std::vector<FacetPairs> plain_layer_groups(const Mesh& mesh_a, const std::vector<Vec3>& a, const Mesh& mesh_b,
                                           const std::vector<Vec3>& b, double thickness,
                                           const LayerRule& acts = all_act);

/// The least distance of two facets; 0 where they cross.
double plain_facet_distance(const std::vector<Vec3>& a, const Facet& f, const std::vector<Vec3>& b, const Facet& g);

}  // namespace morula::test
