// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/exact.hpp"

#include <algorithm>
#include <array>

#include "update/farthest.hpp"

namespace morula {
namespace {

constexpr std::size_t nodes_per_chunk = 64;
constexpr std::size_t leaves_per_chunk = 16;

// How many levels above and including `level` follow the rule: the slot after that level's own.
std::size_t exact_levels_to(std::span<const Rule> rule_of_level, std::size_t level) {
  return static_cast<std::size_t>(
      std::count(rule_of_level.begin(), rule_of_level.begin() + static_cast<std::ptrdiff_t>(level) + 1, Rule::exact));
}

// Points that may anchor a centre: those the node owns, and vertices not much farther off than its sphere reaches, so
// that a centre inside the body finds anchors on all sides.
void find_candidates(const Binding& binding, std::uint32_t node, std::span<const std::uint32_t> owned,
                     std::vector<std::uint32_t>& facets, std::vector<std::uint32_t>& candidates) {
  constexpr double reach = 1.3;
  const Sphere& rest = binding.tree.spheres[node];
  const Sphere around{rest.center, reach * rest.radius};
  candidates.assign(owned.begin(), owned.end());
  binding.bvh.facets_touching(around, facets);
  for (const std::uint32_t f : facets)
    for (const std::uint32_t v : binding.mesh.facets[f])
      if (distance(binding.mesh.positions[v], around.center) <= around.radius)
        candidates.push_back(binding.local.point_of(v));
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
}

}  // namespace

std::vector<std::uint8_t> leaves_below_exact(const SphereTree& tree, const LeafOrder& order,
                                             std::span<const Rule> rule_of_level) {
  std::vector<std::uint8_t> below;
  for (const std::uint32_t leaf : order.leaves)
    below.push_back(exact_levels_to(rule_of_level, tree.level_of(leaf)) > 0);
  return below;
}

ExactRule::ExactRule(const Binding& binding, const LeafOrder& order, const Ownership& ownership) {
  const SphereTree& tree = binding.tree;
  for (std::size_t level = 0; level < tree.level_count(); ++level)
    if (binding.rule_of_level[level] == Rule::exact)
      for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node)
        nodes_.push_back({node, order.begin[node], order.end[node],
                          static_cast<std::uint32_t>(exact_levels_to(binding.rule_of_level, level) - 1)});

  std::vector<std::uint32_t> chain;
  point_begin_.push_back(0);
  chain_begin_.push_back(0);
  for (std::size_t k = 0; k < order.leaves.size(); ++k) {
    chain.clear();
    std::uint32_t level = tree.level_of(order.leaves[k]);
    for (std::uint32_t node = order.leaves[k]; node != no_node; node = tree.parent[node], --level)
      if (binding.rule_of_level[level] == Rule::exact) chain.push_back(node);
    chain_.insert(chain_.end(), chain.rbegin(), chain.rend());
    chain_begin_.push_back(static_cast<std::uint32_t>(chain_.size()));
    if (!chain.empty()) {
      const auto owned = ownership.of_leaf(k);
      owned_points_ += owned.size();
      tested_points_ += owned.size() * chain.size();
      points_.insert(points_.end(), owned.begin(), owned.end());
      while (points_.size() % points_per_group != 0) points_.push_back(owned.back());
    }
    point_begin_.push_back(static_cast<std::uint32_t>(points_.size()));
  }
  squared_.resize(chain_.size());

  // Candidates are independent, so they are looked for side by side; ties are stored in node order.
  std::vector<Anchors> chunks((nodes_.size() + nodes_per_chunk - 1) / nodes_per_chunk);
  parallel_for(binding.workers, nodes_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> facets, candidates;
    for (std::size_t k = begin; k < end; ++k) {
      const Node& n = nodes_[k];
      const std::uint32_t first = ownership.begin[n.leaf_begin], last = ownership.begin[n.leaf_end];
      find_candidates(binding, n.node, std::span(ownership.points).subspan(first, last - first), facets, candidates);
      const Spheref& rest = binding.rest_spheres[n.node];
      chunks[begin / nodes_per_chunk].tie(rest.center, rest.radius, binding.local.points(), candidates);
    }
  });
  for (const Anchors& chunk : chunks) anchors_.append(chunk);
}

void ExactRule::update(std::span<const LocalPoint> points, const Rounding& rounding, std::span<Spheref> spheres,
                       Workers& workers) noexcept {
  move_centers(points, spheres, workers);
  measure_leaves(points, spheres, workers);
  set_radii(rounding, spheres, workers);
}

void ExactRule::move_centers(std::span<const LocalPoint> points, std::span<Spheref> spheres,
                             Workers& workers) noexcept {
  parallel_for(workers, nodes_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) spheres[nodes_[k].node].center = anchors_.center(k, points);
  });
}

void ExactRule::measure_leaves(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                               Workers& workers) noexcept {
  parallel_for(workers, chain_begin_.size() - 1, leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    const FarthestKernel farthest_of = farthest_kernels().back();
    std::array<Vec3f, most_centers> centers;
    for (std::size_t k = begin; k < end; ++k) {
      const auto points_of_leaf = std::span(points_).subspan(point_begin_[k], point_begin_[k + 1] - point_begin_[k]);
      for (std::uint32_t from = chain_begin_[k]; from < chain_begin_[k + 1]; from += most_centers) {
        const std::size_t count = std::min<std::size_t>(most_centers, chain_begin_[k + 1] - from);
        for (std::size_t i = 0; i < count; ++i) centers[i] = spheres[chain_[from + i]].center;
        farthest_of(points.data(), points_of_leaf, std::span(centers).first(count), &squared_[from]);
      }
    }
  });
}

void ExactRule::set_radii(const Rounding& rounding, std::span<Spheref> spheres, Workers& workers) noexcept {
  parallel_for(workers, nodes_.size(), 4 * nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const Node& n = nodes_[k];
      float squared = 0;
      for (std::uint32_t leaf = n.leaf_begin; leaf < n.leaf_end; ++leaf)
        squared = std::max(squared, squared_[chain_begin_[leaf] + n.slot]);
      Spheref& sphere = spheres[n.node];
      sphere.radius = rounding.covering_radius(squared, sphere.center);
    }
  });
}

}  // namespace morula
