// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/corner_walk.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "parallel/interruption.hpp"
#include "update/points/point_runs.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t leaves_per_chunk = 8;
constexpr std::size_t least_groups = 32;  // of a leaf that gains by leaving some out

}  // namespace

CornerWalk::CornerWalk(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
                       std::span<const std::uint8_t> measured) {
  std::vector<std::uint32_t> number(tree.node_count()), above(tree.node_count());  // above: measured ones
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    if (const std::uint32_t parent = tree.parent[node]; parent != no_node)
      above[node] = above[parent] + measured[parent];
    if (measured[node] == 0) continue;
    number[node] = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back(node);
    below_.push_back({order.begin[node], order.end[node], above[node]});
  }

  std::vector<std::uint32_t> chain, levels;
  run_begin_.push_back(0);
  point_begin_.push_back(0);
  chain_begin_.push_back(0);
  for (std::size_t k = 0; k < order.leaves.size(); ++k) {
    chain.clear();
    for (std::uint32_t node = order.leaves[k]; node != no_node; node = tree.parent[node])
      if (measured[node] != 0) chain.push_back(number[node]);
    chain_.insert(chain_.end(), chain.rbegin(), chain.rend());
    chain_begin_.push_back(static_cast<std::uint32_t>(chain_.size()));
    if (!chain.empty()) {
      levels.clear();
      for (auto node = chain.rbegin(); node != chain.rend(); ++node) levels.push_back(tree.level_of(nodes_[*node]));
      const auto owned = ownership.of_leaf(k);
      owned_points_ += owned.size();
      list_points(owned, ownership.tested_from_of_leaf(k), levels);
    }
    run_begin_.push_back(static_cast<std::uint32_t>(runs_.size()));
    point_begin_.push_back(static_cast<std::uint32_t>(points_.size()));
  }
  squared_.resize(chain_.size());
  path_then_.resize(chain_.size());
  path_.resize(nodes_.size());
  bounds_.resize(order.leaves.size());
  squared_before_.resize(tree.level_count());
  squared_reach_.resize(nodes_.size());
  searched_ = Marks(nodes_.size());
  groups_known_ = Marks(leaf_count());
  group_begin_.push_back(0);
  for (std::size_t leaf = 0; leaf < leaf_count(); ++leaf) {
    std::size_t count = point_begin_[leaf + 1] - point_begin_[leaf];
    for (std::uint32_t r = run_begin_[leaf]; r < run_begin_[leaf + 1]; ++r) count += runs_[r].end - runs_[r].begin;
    const std::size_t groups = count / points_per_group;
    group_begin_.push_back(group_begin_.back() + static_cast<std::uint32_t>(groups < least_groups ? 0 : groups));
  }
  groups_.resize(group_begin_.back());
  if (!groups_.empty()) group_center_.resize(leaf_count());
}

// levels: of the chain's nodes.
void CornerWalk::list_points(std::span<const std::uint32_t> owned, std::span<const std::uint32_t> tested_from,
                             std::span<const std::uint32_t> levels) {
  const std::size_t first_run = runs_.size(), first_point = points_.size();
  std::vector<std::uint32_t> by_entry;
  std::vector<std::size_t> counts;
  for (std::size_t e = 0; e < levels.size(); ++e) {
    by_entry.clear();
    for (std::size_t i = 0; i < owned.size(); ++i) {
      const std::uint32_t from = tested_from.empty() ? 0 : tested_from[i];
      if (from <= levels[e] && (e == 0 || from > levels[e - 1])) by_entry.push_back(owned[i]);
    }
    if (e == 0)
      append_runs(by_entry, runs_, points_);
    else
      points_.insert(points_.end(), by_entry.begin(), by_entry.end());
    counts.push_back(points_.size() - first_point);
  }
  std::size_t in_runs = 0;
  for (std::size_t r = first_run; r < runs_.size(); ++r) in_runs += runs_[r].end - runs_[r].begin;
  while (points_.size() % points_per_group != 0) points_.push_back(points_.back());
  for (const std::size_t count : counts) {
    // mutant walk-groups-cut-short: `(count + points_per_group - 1)` -> `count`
    const std::size_t in_groups = (count + points_per_group - 1) / points_per_group * points_per_group;
    point_end_.push_back(static_cast<std::uint32_t>(first_point + in_groups));
    looked_at_.push_back(static_cast<std::uint32_t>(in_runs + std::min(in_groups, counts.back())));
    tested_points_ += looked_at_.back();
  }
}

void CornerWalk::measure_first(std::size_t count, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                               Workers& workers) noexcept {
  const Uninterrupted whole;
  if (!paths_are_zero_) {
    std::fill(path_.begin(), path_.end(), 0.0);
    std::fill(path_then_.begin(), path_then_.end(), 0.0);  // those that are not measured now are not asked for
    // mutant walk-groups-through-whole-updates: `groups_known_.clear()` -> ``
    groups_known_.clear();
    paths_are_zero_ = true;
  }
  parallel_for(workers, leaf_count(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    kernels().farthest_of_leaves(points.data(), lists(), begin, end, count, spheres.data(), squared_.data());
  });
  std::fill_n(squared_reach_.begin(), count, 0.0f);
  const auto raise = [&](std::uint32_t k, float squared) {
    if (k < count) squared_reach_[k] = std::max(squared_reach_[k], squared);
  };
  // Most leaves follow one of the same nodes above: of four in a chain, the largest so far stay in a register.
  constexpr std::size_t together = 4;
  Float4 most(0.0f);
  const std::uint32_t* above = nullptr;  // of whom: the chain of a leaf below them
  const auto finish = [&] {
    if (above == nullptr) return;
    const auto squared = most.lanes();
    for (std::size_t i = 0; i + 1 < together; ++i) raise(above[i], squared[i]);
    above = nullptr;
  };
  for (std::size_t leaf = 0; leaf < leaf_count(); ++leaf) {
    const std::size_t begin = chain_begin_[leaf], end = chain_begin_[leaf + 1];
    if (end - begin != together) {
      for (std::size_t entry = begin; entry < end; ++entry) raise(chain_[entry], squared_[entry]);
      continue;
    }
    const std::uint32_t* const chain = &chain_[begin];
    const Float4 squared = Float4::load(&squared_[begin]);
    if (above != nullptr && above[2] == chain[2]) {
      // mutant walk-reach-of-one-leaf: `max(most, squared)` -> `squared`
      most = max(most, squared);
    } else {
      finish();
      above = chain, most = squared;
    }
    raise(chain[3], squared_[begin + 3]);
  }
  finish();
}

void CornerWalk::measure_one(std::size_t k, std::span<const LocalPoint> points,
                             std::span<const Spheref> spheres) noexcept {
  for (std::uint32_t leaf = below_[k].leaf_begin; leaf < below_[k].leaf_end; ++leaf)
    walk(leaf, chain_begin_[leaf] + below_[k].slot, points, spheres);
  squared_reach_[k] = farthest(k);
}

std::size_t CornerWalk::points_of(std::size_t k) const noexcept {
  std::size_t count = 0;
  for (std::uint32_t leaf = below_[k].leaf_begin; leaf < below_[k].leaf_end; ++leaf)
    count += looked_at_[chain_begin_[leaf] + below_[k].slot];
  return count;
}

// Of what was measured last of each leaf below.
float CornerWalk::farthest(std::size_t k) const noexcept {
  float farthest = 0;
  for (std::uint32_t leaf = below_[k].leaf_begin; leaf < below_[k].leaf_end; ++leaf)
    farthest = std::max(farthest, squared_[chain_begin_[leaf] + below_[k].slot]);
  return farthest;
}

std::size_t CornerWalk::walk(std::size_t leaf, std::size_t entry, std::span<const LocalPoint> points,
                             std::span<const Spheref> spheres) noexcept {
  const auto runs = std::span(runs_).subspan(run_begin_[leaf], run_begin_[leaf + 1] - run_begin_[leaf]);
  const auto index = std::span(points_).subspan(point_begin_[leaf], point_end_[entry] - point_begin_[leaf]);
  kernels().farthest(points.data(), runs, index, std::span(&spheres[nodes_[chain_[entry]]].center, 1),
                     &squared_[entry]);
  path_then_[entry] = path_[chain_[entry]];
  return looked_at_[entry];
}

// For all nodes above at once: that costs less than to find out for which of them it has to be.
void CornerWalk::measure_leaf(std::size_t leaf, std::span<const LocalPoint> points,
                              std::span<const Spheref> spheres) noexcept {
  // mutant walk-changed-leaf-not-for-all: `nodes_.size()` -> `leaf == 0 ? nodes_.size() : 1`
  kernels().farthest_of_leaves(points.data(), lists(), leaf, leaf + 1, nodes_.size(), spheres.data(), squared_.data());
  for (std::uint32_t entry = chain_begin_[leaf]; entry < chain_begin_[leaf + 1]; ++entry)
    path_then_[entry] = path_[chain_[entry]];
}

}  // namespace morula::detail
