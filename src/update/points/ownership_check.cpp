// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/ownership_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace morula::detail {
namespace {

using Real = long double;

struct CornerWeights {
  std::array<Real, 3> of_vertex{};  // weights of the facet's vertices
  bool on_facet = true;
};

CornerWeights weights_of(const Cover& cover, const Facet& facet, std::uint32_t corner) {
  CornerWeights result;
  const auto add = [&](std::uint32_t vertex, Real weight) {
    if (weight == 0) return;
    const auto found = std::find(facet.begin(), facet.end(), vertex);
    if (found == facet.end())
      result.on_facet = false;
    else
      result.of_vertex[static_cast<std::size_t>(found - facet.begin())] += weight;
  };
  if (corner < cover.vertex_count) {
    add(corner, 1);
  } else {
    const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
    for (int k = 0; k < 3; ++k) add(cut.vertex[k], cut.weight[k]);
  }
  return result;
}

struct Direction {
  Real x, y;
};

// Largest distance by which a line separates a point from all of `others`; not positive inside their hull.
Real separation(const CornerWeights& point, const std::vector<CornerWeights>& others) {
  const auto x = [](const CornerWeights& w) { return w.of_vertex[1]; };
  const auto y = [](const CornerWeights& w) { return w.of_vertex[2]; };
  Real most = -1;
  const auto try_direction = [&](Direction d) {
    const Real length = std::hypot(d.x, d.y);
    if (!(length > 0)) return;
    Real gap = 4;
    for (const CornerWeights& o : others)
      gap = std::min(gap, (d.x * (x(point) - x(o)) + d.y * (y(point) - y(o))) / length);
    most = std::max(most, gap);
  };
  for (std::size_t i = 0; i < others.size(); ++i) {
    try_direction({x(point) - x(others[i]), y(point) - y(others[i])});
    for (std::size_t j = 0; j < i; ++j) {
      const Direction along{x(others[j]) - x(others[i]), y(others[j]) - y(others[i])};
      try_direction({along.y, -along.x});
      try_direction({-along.y, along.x});
    }
  }
  return most;
}

// The corners of the cover that a node of a level tests in some leaves below it, ascending.
std::vector<std::uint32_t> tested_corners(const Cover& cover, const Ownership& ownership, std::size_t leaf_begin,
                                          std::size_t leaf_end, std::uint32_t level) {
  std::vector<std::uint32_t> tested;
  const std::size_t vertices = ownership.vertices.size();
  for (std::uint32_t i = ownership.begin[leaf_begin]; i < ownership.begin[leaf_end]; ++i) {
    if (!ownership.tested_from.empty() && ownership.tested_from[i] > level) continue;
    const std::uint32_t point = ownership.points[i];
    tested.push_back(point < vertices ? ownership.vertices[point]
                                      : cover.vertex_count + ownership.cut_points[point - vertices]);
  }
  std::sort(tested.begin(), tested.end());
  return tested;
}

}  // namespace

std::vector<std::string> ownership_faults(const MeshView& mesh, const SphereTree& tree, const Cover& cover,
                                          const LeafOrder& order, const Ownership& ownership,
                                          std::span<const std::uint8_t> needs_cut_points, double tolerance) {
  std::vector<std::string> faults;
  // A node tests a part of the points that the leaves of its range test: so the range has to have all leaves below it.
  for (std::uint32_t k = 0; k < order.leaves.size(); ++k)
    for (std::uint32_t node = order.leaves[k]; node != no_node; node = tree.parent[node])
      if (k < order.begin[node] || order.end[node] <= k)
        faults.push_back("node " + std::to_string(node) + " does not look at leaf " + std::to_string(order.leaves[k]));

  std::map<std::uint32_t, std::vector<std::uint32_t>> owned_in_facet;
  std::vector<CornerWeights> surrounding;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const std::uint32_t leaf_begin = order.begin[node], leaf_end = order.end[node];
    const auto flags = needs_cut_points.subspan(leaf_begin, leaf_end - leaf_begin);
    if (std::find(flags.begin(), flags.end(), std::uint8_t{0}) != flags.end()) continue;
    const std::vector<std::uint32_t> tested =
        tested_corners(cover, ownership, leaf_begin, leaf_end, tree.level_of(node));
    const Real allowed = static_cast<Real>(tree.is_leaf(node) ? tolerance : 2 * tolerance);
    const auto is_tested = [&](std::uint32_t c) { return std::binary_search(tested.begin(), tested.end(), c); };
    owned_in_facet.clear();
    for (std::uint32_t p = cover.region_begin[node]; p < cover.region_end[node]; ++p) {
      std::vector<std::uint32_t>& owned = owned_in_facet[cover.patch_facet[p]];
      owned.insert(owned.end(), cover.patch(p).begin(), cover.patch(p).end());
    }
    for (auto& [f, owned] : owned_in_facet) {
      std::sort(owned.begin(), owned.end());
      owned.erase(std::unique(owned.begin(), owned.end()), owned.end());
      if (std::all_of(owned.begin(), owned.end(), is_tested)) continue;
      const Facet& facet = mesh.facets[f];
      surrounding.clear();
      for (const std::uint32_t c : owned)
        if (is_tested(c)) surrounding.push_back(weights_of(cover, facet, c));
      for (const std::uint32_t v : facet)
        if (is_tested(v)) surrounding.push_back(weights_of(cover, facet, v));
      std::erase_if(surrounding, [](const CornerWeights& w) { return !w.on_facet; });
      for (const std::uint32_t c : owned) {
        if (is_tested(c)) continue;
        const CornerWeights at = weights_of(cover, facet, c);
        // Extended precision rounds far less than a double's last place.
        // mutant owned-check-sees-nothing: `allowed` -> `2 + allowed`
        if (!at.on_facet || surrounding.empty() || separation(at, surrounding) > allowed + 0x1p-58L)
          faults.push_back("node " + std::to_string(node) + " owns corner " + std::to_string(c) + " of facet " +
                           std::to_string(f) + ", which lies outside the hull of the points that it tests");
      }
    }
  }
  return faults;
}

}  // namespace morula::detail
