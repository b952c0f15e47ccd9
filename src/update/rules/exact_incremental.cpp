// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/exact_incremental.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace morula::detail {

IncrementalExact::IncrementalExact(const Binding& binding, const CornerChains& chains, const Anchors& anchors,
                                   const PackedCores& cores)
    : walk_(chains),
      changed_leaves_(chains.leaf_count()),
      dependents_(chains.nodes().size()),
      dirty_(chains.nodes().size()) {
  moved_.reserve(chains.nodes().size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> leaves, nodes;
  for (std::uint32_t leaf = 0; leaf < chains.leaf_count(); ++leaf)
    for (const std::uint32_t p : binding.ownership.of_leaf(leaf))
      binding.local.each_block(p, [&](std::uint32_t block) {
        if (leaves.empty() || leaves.back() != std::pair(block, leaf)) leaves.emplace_back(block, leaf);
      });
  for (std::uint32_t k = 0; k < chains.nodes().size(); ++k) {
    const auto depends_on = [&](std::uint32_t p) {
      binding.local.each_block(p, [&](std::uint32_t block) { nodes.emplace_back(block, k); });
    };
    anchors.each_point(k, depends_on);
    const auto [first, count] = cores.of(k);
    // mutant changed-cores-untold: `for (std::size_t i = 0; i < count; ++i) depends_on(first[nodes_at_once * i])` -> ``
    for (std::size_t i = 0; i < count; ++i) depends_on(first[nodes_at_once * i]);
  }
  leaves_of_block_ = BlockLists(std::move(leaves), binding.local.block_count());
  nodes_of_block_ = BlockLists(std::move(nodes), binding.local.block_count());
}

std::size_t IncrementalExact::update(const Frame& frame, const Marks& changed_blocks) noexcept {
  changed_leaves_.clear(), dependents_.clear(), dirty_.clear(), moved_.clear();
  changed_blocks.each([&](std::uint32_t block) {
    for (const std::uint32_t leaf : leaves_of_block_.of(block)) changed_leaves_.add(leaf);
    for (const std::uint32_t k : nodes_of_block_.of(block)) dependents_.add(k);
  });
  std::array<std::uint32_t, nodes_at_once> nodes;
  std::size_t count = 0;
  dependents_.each([&](std::uint32_t k) {
    nodes[count++] = k;
    if (count == nodes.size()) move_centers(frame, {nodes.data(), std::exchange(count, 0)});
  });
  move_centers(frame, {nodes.data(), count});
  return walk_.measure({frame.walk.chains(), frame.walk.reaches(), frame.points, frame.spheres}, changed_leaves_,
                       moved_, dirty_);
}

// Moves the centers of at most nodes_at_once nodes, ascending, and records how far each moved center has come.
void IncrementalExact::move_centers(const Frame& frame, std::span<const std::uint32_t> nodes) noexcept {
  if (nodes.empty()) return;
  std::array<LocalPoint, nodes_at_once> centers;
  frame.anchors.centers(nodes, frame.points, centers.data());
  std::array<std::uint32_t, core_size * nodes_at_once> points;
  std::array<float, nodes_at_once> radii;
  std::size_t most = 0;
  for (const std::uint32_t k : nodes) most = std::max(most, frame.cores.of(k).count);
  for (std::size_t j = 0; j < nodes_at_once; ++j) {
    const std::uint32_t k = nodes[std::min(j, nodes.size() - 1)];
    if (j >= nodes.size()) centers[j] = centers[nodes.size() - 1];
    radii[j] = frame.cores.rest_radius(k);
    const auto [first, count] = frame.cores.of(k);
    // mutant changed-cores-of-other-lanes: `[nodes_at_once * i]` -> `[nodes_at_once * i / 2]`
    for (std::size_t i = 0; i < count; ++i) points[nodes_at_once * i + j] = first[nodes_at_once * i];
    for (std::size_t i = count; i < most; ++i) points[nodes_at_once * i + j] = *first;
  }
  kernels().pull_many(frame.points.data(), points.data(), most, radii.data(), centers.data());
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    Vec3f& kept = frame.spheres[frame.walk.nodes()[nodes[j]]].center;
    const Vec3f now{centers[j].x, centers[j].y, centers[j].z};
    // Distances are in double, where no square vanishes; the walk's bounds pay for narrowing them
    // (incremental_walk.cpp).
    // mutant moved-a-little-less: `distance` -> `0.98 * distance`
    if (now != kept) moved_.push_back({nodes[j], static_cast<float>(distance(Vec3(now), Vec3(kept)))});
    kept = now;
  }
}

}  // namespace morula::detail
