// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "update/kernels.hpp"
#include "update/outermost.hpp"

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
  run_begin_.push_back(0);
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
      add_points(owned);
    }
    run_begin_.push_back(static_cast<std::uint32_t>(runs_.size()));
    point_begin_.push_back(static_cast<std::uint32_t>(points_.size()));
  }
  squared_.resize(chain_.size());

  // Nodes are independent, so they are looked at side by side; ties are stored in node order.
  core_.resize(core_size * nodes_.size());
  core_radius_.resize(nodes_.size());
  std::vector<Anchors> chunks((nodes_.size() + nodes_per_chunk - 1) / nodes_per_chunk);
  parallel_for(binding.workers, nodes_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> facets, candidates;
    for (std::size_t k = begin; k < end; ++k) {
      const Node& n = nodes_[k];
      const std::uint32_t first = ownership.begin[n.leaf_begin], last = ownership.begin[n.leaf_end];
      const auto owned = std::span(ownership.points).subspan(first, last - first);
      choose_core(k, binding, owned);
      find_candidates(binding, n.node, owned, facets, candidates);
      const Spheref& rest = binding.rest_spheres[n.node];
      chunks[begin / nodes_per_chunk].tie(rest.center, rest.radius, binding.local.points(), candidates);
    }
  });
  for (const Anchors& chunk : chunks) anchors_.append(chunk);
}

// Ascending points of one leaf.
void ExactRule::add_points(std::span<const std::uint32_t> owned) {
  for (std::size_t i = 0; i < owned.size();) {
    std::size_t end = i + 1;
    while (end < owned.size() && owned[end] == owned[end - 1] + 1) ++end;
    const std::size_t in_run = (end - i) / points_per_group * points_per_group;
    if (in_run > 0) runs_.push_back({owned[i], owned[i] + static_cast<std::uint32_t>(in_run)});
    points_.insert(points_.end(), owned.begin() + static_cast<std::ptrdiff_t>(i + in_run),
                   owned.begin() + static_cast<std::ptrdiff_t>(end));
    i = end;
  }
  while (points_.size() % points_per_group != 0) points_.push_back(owned.back());
}

void ExactRule::choose_core(std::size_t k, const Binding& binding, std::span<const std::uint32_t> owned) {
  const std::span<std::uint32_t> core = std::span(core_).subspan(core_size * k, core_size);
  const Vec3f& center = binding.rest_spheres[nodes_[k].node].center;
  outermost(binding.local.points(), owned, center, core);
  float squared = 0;
  kernels().farthest(binding.local.points().data(), {}, core, std::span(&center, 1), &squared);
  core_radius_[k] = std::sqrt(squared);
}

void ExactRule::update(std::span<const LocalPoint> points, const Rounding& rounding, std::span<Spheref> spheres,
                       Workers& workers) noexcept {
  move_centers(points, spheres, workers);
  measure_leaves(points, spheres, workers);
  set_radii(rounding, spheres, workers);
}

void ExactRule::move_centers(std::span<const LocalPoint> points, std::span<Spheref> spheres,
                             Workers& workers) noexcept {
  // Centres of spheres that stay as they were at rest, or nearly, are good: only grown ones are worth a pull.
  constexpr float most_growth = 1.01f;
  parallel_for(workers, nodes_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const float enough = most_growth * core_radius_[k];
      spheres[nodes_[k].node].center = kernels().pull(
          points.data(), {&core_[core_size * k], enough * enough, core_radius_[k]}, anchors_.center(k, points));
    }
  });
}

void ExactRule::measure_leaves(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                               Workers& workers) noexcept {
  parallel_for(workers, chain_begin_.size() - 1, leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::array<Vec3f, most_centers> centers;
    for (std::size_t k = begin; k < end; ++k) {
      const auto runs = std::span(runs_).subspan(run_begin_[k], run_begin_[k + 1] - run_begin_[k]);
      const auto index = std::span(points_).subspan(point_begin_[k], point_begin_[k + 1] - point_begin_[k]);
      for (std::uint32_t from = chain_begin_[k]; from < chain_begin_[k + 1]; from += most_centers) {
        const std::size_t count = std::min<std::size_t>(most_centers, chain_begin_[k + 1] - from);
        for (std::size_t i = 0; i < count; ++i) centers[i] = spheres[chain_[from + i]].center;
        kernels().farthest(points.data(), runs, index, std::span(centers).first(count), &squared_[from]);
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
