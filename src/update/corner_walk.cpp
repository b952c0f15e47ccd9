// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/corner_walk.hpp"

#include <algorithm>
#include <array>
#include <numeric>

namespace morula {
namespace {

constexpr std::size_t leaves_per_chunk = 16;

}  // namespace

CornerWalk::CornerWalk(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
                       std::span<const std::uint8_t> measured) {
  std::vector<std::uint32_t> number(tree.node_count());
  std::uint32_t slot = 0;
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    if (measured[level] == 0) continue;
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      number[node] = static_cast<std::uint32_t>(nodes_.size());
      nodes_.push_back(node);
      below_.push_back({order.begin[node], order.end[node], slot});
    }
    ++slot;
  }

  std::vector<std::uint32_t> chain;
  run_begin_.push_back(0);
  point_begin_.push_back(0);
  chain_begin_.push_back(0);
  for (std::size_t k = 0; k < order.leaves.size(); ++k) {
    chain.clear();
    std::uint32_t level = tree.level_of(order.leaves[k]);
    for (std::uint32_t node = order.leaves[k]; node != no_node; node = tree.parent[node], --level)
      if (measured[level] != 0) chain.push_back(number[node]);
    chain_.insert(chain_.end(), chain.rbegin(), chain.rend());
    chain_begin_.push_back(static_cast<std::uint32_t>(chain_.size()));
    points_of_leaf_.push_back(0);
    if (!chain.empty()) {
      const auto owned = ownership.of_leaf(k);
      points_of_leaf_.back() = static_cast<std::uint32_t>(owned.size());
      owned_points_ += owned.size();
      tested_points_ += owned.size() * chain.size();
      add_points(owned);
    }
    run_begin_.push_back(static_cast<std::uint32_t>(runs_.size()));
    point_begin_.push_back(static_cast<std::uint32_t>(points_.size()));
  }
  squared_.resize(chain_.size());
  leaf_tests_.resize(order.leaves.size());
}

// Ascending points of one leaf.
void CornerWalk::add_points(std::span<const std::uint32_t> owned) {
  for (std::size_t i = 0; i < owned.size();) {
    std::size_t end = i + 1;
    while (end < owned.size() && owned[end] == owned[end - 1] + 1) ++end;
    const std::size_t in_run = (end - i) / points_per_group * points_per_group;
    if (in_run > 0) runs_.push_back({owned[i], owned[i] + static_cast<std::uint32_t>(in_run)});
    const auto rest = owned.subspan(i + in_run, end - i - in_run);
    points_.insert(points_.end(), rest.begin(), rest.end());
    i = end;
  }
  while (points_.size() % points_per_group != 0) points_.push_back(owned.back());
}

void CornerWalk::measure(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                         Workers& workers) noexcept {
  parallel_for(workers, leaf_count(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, most_centers> entries{};
    for (std::size_t k = begin; k < end; ++k)
      for (std::uint32_t from = chain_begin_[k]; from < chain_begin_[k + 1]; from += most_centers) {
        const std::uint32_t count = std::min<std::uint32_t>(most_centers, chain_begin_[k + 1] - from);
        for (std::uint32_t i = 0; i < count; ++i) entries[i] = from + i;
        walk(k, std::span(entries).first(count), points, spheres);
      }
  });
}

std::size_t CornerWalk::measure_again(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                               std::span<const std::uint8_t> leaf_changed, std::span<const std::uint8_t> node_moved,
                               Workers& workers) noexcept {
  parallel_for(workers, leaf_count(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::array<std::uint32_t, most_centers> entries{};
    for (std::size_t k = begin; k < end; ++k) {
      std::size_t count = 0;
      leaf_tests_[k] = 0;
      for (std::uint32_t entry = chain_begin_[k]; entry < chain_begin_[k + 1]; ++entry) {
        if (leaf_changed[k] != 0 || node_moved[chain_[entry]] != 0) entries[count++] = entry;
        if (count < most_centers && entry + 1 < chain_begin_[k + 1]) continue;
        if (count > 0) walk(k, std::span(entries).first(count), points, spheres);
        leaf_tests_[k] += static_cast<std::uint32_t>(count * points_of_leaf_[k]);
        count = 0;
      }
    }
  });
  return std::accumulate(leaf_tests_.begin(), leaf_tests_.end(), std::size_t{0});
}

void CornerWalk::walk(std::size_t leaf, std::span<const std::uint32_t> entries, std::span<const LocalPoint> points,
                      std::span<const Spheref> spheres) noexcept {
  std::array<Vec3f, most_centers> centers;
  std::array<float, most_centers> squared{};
  for (std::size_t i = 0; i < entries.size(); ++i) centers[i] = spheres[nodes_[chain_[entries[i]]]].center;
  const auto runs = std::span(runs_).subspan(run_begin_[leaf], run_begin_[leaf + 1] - run_begin_[leaf]);
  const auto index = std::span(points_).subspan(point_begin_[leaf], point_begin_[leaf + 1] - point_begin_[leaf]);
  kernels().farthest(points.data(), runs, index, std::span(centers).first(entries.size()), squared.data());
  for (std::size_t i = 0; i < entries.size(); ++i) squared_[entries[i]] = squared[i];
}

float CornerWalk::squared_reach(std::size_t k) const noexcept {
  const Below& b = below_[k];
  float squared = 0;
  for (std::uint32_t leaf = b.leaf_begin; leaf < b.leaf_end; ++leaf)
    squared = std::max(squared, squared_[chain_begin_[leaf] + b.slot]);
  return squared;
}

}  // namespace morula
