// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Surfaces in motion, and their features counted and measured without any tree: oracles that share no code with it.
#pragma once

#include <algorithm>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/surface_tree.hpp>
#include <support/meshes.hpp>
#include <vector>

namespace morula::test {

/// A surface and where it goes.
struct Moving {
  Mesh mesh;
  std::vector<Vec3> from, to;
};

/// Coordinates are whole numbers from -reach to reach: much is aligned, coplanar or the same.
Moving random_soup(std::size_t vertices, std::size_t facets, int reach, Random& random);
/// A tube of sheets with noise, whose vertices move by about `step`.
Moving wavy_sheet(int n, double step, Random& random);

using Vertices = std::vector<std::uint32_t>;
/// By the vertices of both features, those of each ascending, the lower list first of one surface with itself.
struct PlainPair {
  Vertices a, b;
  auto operator<=>(const PlainPair&) const = default;
};
PlainPair plain_pair(Vertices a, Vertices b, bool with_itself);

/// Vertices that facets use, edges and facets, each as the vertices it has.
std::vector<Vertices> plain_vertices(const Mesh& mesh);
std::vector<Vertices> plain_edges(const Mesh& mesh);
std::vector<Vertices> plain_facets(const Mesh& mesh);

/// All pairs of a vertex and a facet and of two edges that have no vertex in common (of one surface with itself), with
/// what `keep` says of them.
template <class Keep>
std::vector<PlainPair> pairs_with_itself(const Mesh& mesh, const Keep& keep) {
  std::vector<PlainPair> found;
  const auto share = [](const Vertices& a, const Vertices& b) {
    for (const std::uint32_t v : a)
      for (const std::uint32_t w : b)
        if (v == w) return true;
    return false;
  };
  const auto vertices = plain_vertices(mesh), edges = plain_edges(mesh), facets = plain_facets(mesh);
  for (const Vertices& v : vertices)
    for (const Vertices& f : facets)
      if (!share(v, f) && keep(v, f)) found.push_back(plain_pair(v, f, true));
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size(); ++j)
      if (!share(edges[i], edges[j]) && keep(edges[i], edges[j])) found.push_back(plain_pair(edges[i], edges[j], true));
  std::sort(found.begin(), found.end());
  return found;
}

/// The vertices of what a query found.
PlainPair plain_pair(const SurfaceTree& a, const SurfaceTree& b, const FeaturePair& pair);
template <class Pairs>
std::vector<PlainPair> plain_pairs(const SurfaceTree& a, const SurfaceTree& b, const Pairs& pairs) {
  std::vector<PlainPair> found;
  for (const FeaturePair& pair : pairs) found.push_back(plain_pair(a, b, pair));
  std::sort(found.begin(), found.end());
  return found;
}

/// The least distance of two points, segments or triangles of which one is a point or both are segments.
long double plain_distance(const std::vector<Vec3>& points, const Vertices& a, const Vertices& b);

}  // namespace morula::test
