// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/tree/cover.hpp>
#include <stdexcept>
#include <string>

namespace morula {
namespace {

constexpr std::uint32_t unnumbered = 0xffffffffu;

// The new number of each old vertex.
std::vector<std::uint32_t> inverse(std::span<const std::uint32_t> order, std::size_t vertex_count) {
  if (order.size() != vertex_count)
    throw std::invalid_argument("an order of " + std::to_string(order.size()) + " vertices for " +
                                std::to_string(vertex_count));
  std::vector<std::uint32_t> number(vertex_count, unnumbered);
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    if (order[i] >= vertex_count || number[order[i]] != unnumbered)
      throw std::invalid_argument("the order does not name every vertex once: entry " + std::to_string(i) + " is " +
                                  std::to_string(order[i]));
    number[order[i]] = i;
  }
  return number;
}

}  // namespace

std::vector<std::uint32_t> leaf_order(const CoveredTree& model) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
    if (model.tree.is_leaf(node)) leaves.push_back(node);
  const Cover& cover = model.cover;
  // Regions lie depth first.
  std::sort(leaves.begin(), leaves.end(),
            [&](std::uint32_t a, std::uint32_t b) { return cover.region_begin[a] < cover.region_begin[b]; });

  std::vector<std::uint32_t> order;
  std::vector<std::uint8_t> seen(cover.vertex_count);
  for (const std::uint32_t leaf : leaves) {
    const auto begin = static_cast<std::ptrdiff_t>(order.size());
    for (const std::uint32_t c : cover.region_corners(leaf))
      if (c < cover.vertex_count && seen[c] == 0) seen[c] = 1, order.push_back(c);
    std::sort(order.begin() + begin, order.end());
  }
  for (std::uint32_t v = 0; v < cover.vertex_count; ++v)
    if (seen[v] == 0) order.push_back(v);
  return order;
}

Mesh renumbered(const MeshView& mesh, std::span<const std::uint32_t> order) {
  const std::vector<std::uint32_t> number = inverse(order, mesh.vertex_count());
  Mesh result = to_mesh(mesh);
  for (std::size_t i = 0; i < order.size(); ++i) result.positions[i] = mesh.positions[order[i]];
  for (Facet& facet : result.facets)
    for (std::uint32_t& v : facet) v = number[v];
  return result;
}

CoveredTree renumbered(const CoveredTree& model, const MeshView& mesh, std::span<const std::uint32_t> order) {
  const std::vector<std::uint32_t> number = inverse(order, model.cover.vertex_count);
  CoveredTree result = model;
  for (std::uint32_t& c : result.cover.corners)
    if (c < model.cover.vertex_count) c = number[c];
  for (CutPoint& cut : result.cover.cut_points)
    for (std::uint32_t& v : cut.vertex) v = number[v];
  result.report.mesh_hash = mesh_hash(mesh);
  for (KnownPose& pose : result.poses) {
    const std::vector<Vec3> before = pose.positions;
    for (std::size_t i = 0; i < order.size(); ++i) pose.positions[i] = before[order[i]];
    const MeshView posed(pose.positions, mesh.facets);
    pose.model = std::make_shared<const CoveredTree>(renumbered(*pose.model, posed, order));
  }
  return result;
}

}  // namespace morula
