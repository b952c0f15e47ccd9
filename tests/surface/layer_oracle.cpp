// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "layer_oracle.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "surfaces.hpp"

namespace morula::test {
namespace {

bool is_proper(const Facet& f) {
  return f[0] != f[1] && f[1] != f[2] && f[2] != f[0];
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;
std::map<Edge, std::vector<std::uint32_t>> edges_of(const Mesh& mesh) {
  std::map<Edge, std::vector<std::uint32_t>> edges;
  for (std::uint32_t i = 0; i < mesh.facets.size(); ++i)
    if (const Facet& f = mesh.facets[i]; is_proper(f))
      for (std::size_t k = 0; k < 3; ++k) edges[std::minmax(f[k], f[(k + 1) % 3])].push_back(i);
  return edges;
}

double area_of(const std::vector<Vec3>& at, const Facet& f) {
  return 0.5 * length(cross(at[f[1]] - at[f[0]], at[f[2]] - at[f[0]]));
}

/// The simplexes of some facets, each with its coefficient.
std::vector<std::pair<Vertices, double>> coefficients(const Mesh& mesh, const std::vector<std::uint32_t>& facets) {
  std::map<Edge, int> edges;
  std::map<std::uint32_t, double> vertices;
  std::vector<std::pair<Vertices, double>> all;
  for (const std::uint32_t i : facets) {
    const Facet& f = mesh.facets[i];
    all.push_back({{f[0], f[1], f[2]}, 1});
    for (std::size_t k = 0; k < 3; ++k) {
      ++edges[std::minmax(f[k], f[(k + 1) % 3])];
      vertices.try_emplace(f[k], 1.0).first->second -= 1;
    }
  }
  for (const auto& [edge, count] : edges) {
    all.push_back({{edge.first, edge.second, edge.second}, 1.0 - count});
    for (const std::uint32_t v : {edge.first, edge.second}) vertices[v] += count - 1;
  }
  for (const auto& [v, coefficient] : vertices) all.push_back({{v, v, v}, coefficient});
  return all;
}

}  // namespace

double plain_layer(const Mesh& rest_a, const std::vector<Vec3>& a, const Mesh& mesh_b, const std::vector<Vec3>& b,
                   double thickness, int points, const LayerRule& acts) {
  std::vector<Vec3> with_x = b;
  with_x.push_back({});
  const auto x_of = static_cast<std::uint32_t>(b.size());
  double sum = 0;
  for (const auto& entry : edges_of(rest_a)) {
    const Edge& edge = entry.first;
    const std::vector<std::uint32_t>& facets = entry.second;
    double weight = 0;
    for (const std::uint32_t i : facets) weight += area_of(rest_a.positions, rest_a.facets[i]) / 3;
    std::vector<std::uint32_t> acting;
    for (std::uint32_t j = 0; j < mesh_b.facets.size(); ++j)
      if (is_proper(mesh_b.facets[j]) &&
          std::any_of(facets.begin(), facets.end(), [&](std::uint32_t i) { return acts(i, j); }) &&
          plain_facet_distance(a, {edge.first, edge.second, edge.second}, b, mesh_b.facets[j]) < thickness)
        acting.push_back(j);
    if (acting.empty()) continue;
    auto simplexes = coefficients(mesh_b, acting);
    std::erase_if(simplexes, [&](const auto& simplex) {
      const Vertices& v = simplex.first;
      return simplex.second == 0 ||
             plain_facet_distance(a, {edge.first, edge.second, edge.second}, b, {v[0], v[1], v[2]}) >= thickness;
    });
    for (int k = 0; k < points; ++k) {
      with_x[x_of] = a[edge.first] + (a[edge.second] - a[edge.first]) * ((k + 0.5) / points);
      for (const auto& [simplex, coefficient] : simplexes) {
        const double d = static_cast<double>(plain_distance(with_x, {x_of}, simplex));
        if (d < thickness) sum += weight / points * coefficient * (thickness - d) * (thickness - d) / (2 * thickness);
      }
    }
  }
  return sum;
}

double plain_facet_distance(const std::vector<Vec3>& a, const Facet& f, const std::vector<Vec3>& b, const Facet& g) {
  std::vector<Vec3> all;
  for (const std::uint32_t v : f) all.push_back(a[v]);
  for (const std::uint32_t v : g) all.push_back(b[v]);
  long double least = 1e300L;
  for (std::uint32_t i = 0; i < 3; ++i) {
    least = std::min({least, plain_distance(all, {i}, {3, 4, 5}), plain_distance(all, {i + 3}, {0, 1, 2})});
    for (std::uint32_t j = 0; j < 3; ++j)
      least = std::min(least, plain_distance(all, {i, (i + 1) % 3}, {j + 3, (j + 1) % 3 + 3}));
  }
  // An edge may pass through the other facet far from its borders.
  const auto pierces = [&](std::uint32_t p, std::uint32_t q, std::uint32_t t) {
    const auto volume = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k, std::uint32_t l) {
      return dot(cross(all[j] - all[i], all[k] - all[i]), all[l] - all[i]);
    };
    const double below = volume(t, t + 1, t + 2, p), above = volume(t, t + 1, t + 2, q);
    if (!(below * above < 0)) return false;
    const double s[3] = {volume(p, q, t, t + 1), volume(p, q, t + 1, t + 2), volume(p, q, t + 2, t)};
    return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
  };
  for (std::uint32_t i = 0; i < 3; ++i)
    if (pierces(i, (i + 1) % 3, 3) || pierces(i + 3, (i + 1) % 3 + 3, 0)) return 0;
  return static_cast<double>(least);
}

std::vector<FacetPairs> plain_layer_groups(const Mesh& mesh_a, const std::vector<Vec3>& a, const Mesh& mesh_b,
                                           const std::vector<Vec3>& b, double thickness, const LayerRule& acts) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t i = 0; i < mesh_a.facets.size(); ++i)
    for (std::uint32_t j = 0; j < mesh_b.facets.size(); ++j)
      if (is_proper(mesh_a.facets[i]) && is_proper(mesh_b.facets[j]) && acts(i, j) &&
          plain_facet_distance(a, mesh_a.facets[i], b, mesh_b.facets[j]) < thickness)
        pairs.push_back({i, j});
  const auto share = [](const Facet& f, const Facet& g) {
    return std::any_of(f.begin(), f.end(),
                       [&](std::uint32_t v) { return std::find(g.begin(), g.end(), v) != g.end(); });
  };
  std::vector<FacetPairs> groups;
  std::vector<bool> seen(pairs.size(), false);
  for (std::size_t first = 0; first < pairs.size(); ++first) {
    if (seen[first]) continue;
    std::vector<std::size_t> stack{first};
    seen[first] = true;
    FacetPairs group;
    while (!stack.empty()) {
      const auto [i, j] = pairs[stack.back()];
      stack.pop_back();
      group.insert({i, j});
      for (std::size_t k = 0; k < pairs.size(); ++k)
        if (!seen[k] && ((pairs[k].first == i && share(mesh_b.facets[pairs[k].second], mesh_b.facets[j])) ||
                         (pairs[k].second == j && share(mesh_a.facets[pairs[k].first], mesh_a.facets[i]))))
          seen[k] = true, stack.push_back(k);
    }
    groups.push_back(group);
  }
  return groups;
}

}  // namespace morula::test
