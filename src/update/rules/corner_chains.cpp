// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/corner_chains.hpp"

#include <algorithm>

#include "update/points/point_runs.hpp"

namespace morula::detail {

CornerChains::CornerChains(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
                           std::span<const std::uint8_t> measured) {
  constexpr std::uint32_t unmeasured = no_node;
  std::vector<std::uint32_t> number(tree.node_count(), unmeasured), above(tree.node_count());  // above: measured ones
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    if (const std::uint32_t parent = tree.parent[node]; parent != no_node)
      above[node] = above[parent] + measured[parent];
    if (measured[node] == 0) continue;
    number[node] = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    below_.push_back({order.begin[node], order.end[node], above[node]});
  }
  std::vector<std::uint32_t> levels;
  for (std::size_t leaf = 0; leaf < order.leaves.size(); ++leaf) {
    append_chain(tree, order.leaves[leaf], number);
    levels.clear();
    for (std::uint32_t entry = begin(leaf); entry < end(leaf); ++entry)
      levels.push_back(static_cast<std::uint32_t>(tree.level_of(nodes_[chain_[entry]])));
    if (!levels.empty()) {
      const auto owned = ownership.of_leaf(leaf);
      owned_points_ += owned.size();
      list_points(owned, ownership.tested_from_of_leaf(leaf), levels);
    }
    lists_.end_leaf();
  }
}

void CornerChains::append_chain(const SphereTree& tree, std::uint32_t leaf_node,
                                std::span<const std::uint32_t> number) {
  const auto begin = static_cast<std::ptrdiff_t>(chain_.size());
  for (std::uint32_t node = leaf_node; node != no_node; node = tree.parent[node])
    if (number[node] != no_node) chain_.push_back(number[node]);
  std::reverse(chain_.begin() + begin, chain_.end());
  chain_begin_.push_back(static_cast<std::uint32_t>(chain_.size()));
}

// levels: levels of the chain's nodes.
void CornerChains::list_points(std::span<const std::uint32_t> owned, std::span<const std::uint32_t> tested_from,
                               std::span<const std::uint32_t> levels) {
  std::vector<std::uint32_t>& points = lists_.points;
  const std::size_t first_run = lists_.runs.size(), first_point = points.size();
  std::vector<std::uint32_t> by_entry;
  std::vector<std::size_t> counts;
  for (std::size_t e = 0; e < levels.size(); ++e) {
    by_entry.clear();
    for (std::size_t i = 0; i < owned.size(); ++i) {
      const std::uint32_t from = tested_from.empty() ? 0 : tested_from[i];
      if (from <= levels[e] && (e == 0 || from > levels[e - 1])) by_entry.push_back(owned[i]);
    }
    if (e == 0)
      append_runs(by_entry, lists_.runs, points);
    else
      points.insert(points.end(), by_entry.begin(), by_entry.end());
    counts.push_back(points.size() - first_point);
  }
  std::size_t in_runs = 0;
  for (std::size_t r = first_run; r < lists_.runs.size(); ++r) in_runs += lists_.runs[r].end - lists_.runs[r].begin;
  while (points.size() % points_per_group != 0) points.push_back(points.back());
  for (const std::size_t count : counts) {
    // mutant walk-groups-cut-short: `(count + points_per_group - 1)` -> `count`
    const std::size_t in_groups = (count + points_per_group - 1) / points_per_group * points_per_group;
    point_end_.push_back(static_cast<std::uint32_t>(first_point + in_groups));
    test_count_.push_back(static_cast<std::uint32_t>(in_runs + std::min(in_groups, counts.back())));
    tested_points_ += test_count_.back();
  }
}

std::size_t CornerChains::padded_count(std::size_t leaf) const noexcept {
  std::size_t count = lists_.point_begin[leaf + 1] - lists_.point_begin[leaf];
  for (std::uint32_t r = lists_.run_begin[leaf]; r < lists_.run_begin[leaf + 1]; ++r)
    count += lists_.runs[r].end - lists_.runs[r].begin;
  return count;
}

std::size_t CornerChains::points_of(std::uint32_t k) const noexcept {
  std::size_t count = 0;
  for (std::uint32_t leaf = below_[k].leaf_begin; leaf < below_[k].leaf_end; ++leaf)
    count += test_count_[begin(leaf) + below_[k].slot];
  return count;
}

float CornerChains::farthest(std::size_t leaf, std::size_t entry, std::span<const LocalPoint> points,
                             std::span<const Spheref> spheres) const noexcept {
  const auto [runs, index] = tested(leaf, entry);
  float squared = 0;
  kernels().farthest(points.data(), runs, index, std::span(&spheres[nodes_[chain_[entry]]].center, 1), &squared);
  return squared;
}

void CornerChains::farthest_of_leaves(std::size_t begin, std::size_t end, std::size_t count,
                                      std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                                      std::span<float> squared) const noexcept {
  const PointLists& l = lists_;
  const LeafLists lists{l.runs.data(),     l.run_begin.data(), l.points.data(),     l.point_begin.data(),
                        point_end_.data(), chain_.data(),      chain_begin_.data(), nodes_.data()};
  kernels().farthest_of_leaves(points.data(), lists, begin, end, count, spheres.data(), squared.data());
}

}  // namespace morula::detail
