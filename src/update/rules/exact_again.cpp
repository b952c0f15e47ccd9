// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `exact` where a part of the vertices has moved.
#include <algorithm>
#include <array>
#include <utility>

#include "update/points/kernels.hpp"
#include "update/rules/exact.hpp"

namespace morula::detail {

void ExactRule::find_dependents(const Binding& binding) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> leaves, nodes;
  for (std::uint32_t leaf = 0; leaf < walk_.leaf_count(); ++leaf)
    for (const std::uint32_t p : binding.ownership.of_leaf(leaf))
      binding.local.each_block(p, [&](std::uint32_t block) {
        if (leaves.empty() || leaves.back() != std::pair(block, leaf)) leaves.emplace_back(block, leaf);
      });
  for (std::uint32_t k = 0; k < walk_.nodes().size(); ++k) {
    const auto depends_on = [&](std::uint32_t p) {
      binding.local.each_block(p, [&](std::uint32_t block) { nodes.emplace_back(block, k); });
    };
    anchors_.each_point(k, depends_on);
    const auto [first, count] = core_of(k);
    // mutant changed-cores-untold: `for (std::size_t i = 0; i < count; ++i) depends_on(first[nodes_at_once * i])` -> ``
    for (std::size_t i = 0; i < count; ++i) depends_on(first[nodes_at_once * i]);
  }
  leaves_of_block_ = BlockLists(std::move(leaves), binding.local.block_count());
  nodes_of_block_ = BlockLists(std::move(nodes), binding.local.block_count());
  changed_leaves_ = Marks(walk_.leaf_count());
  hanging_ = touched_ = Marks(walk_.nodes().size());
  moved_.reserve(walk_.nodes().size());
}

std::size_t ExactRule::update_changed(const RuleFrame& frame, const Marks& changed_blocks,
                                      std::span<Spheref> spheres) noexcept {
  changed_leaves_.clear(), hanging_.clear(), touched_.clear(), moved_.clear();
  changed_blocks.each([&](std::uint32_t block) {
    for (const std::uint32_t leaf : leaves_of_block_.of(block)) changed_leaves_.add(leaf);
    for (const std::uint32_t k : nodes_of_block_.of(block)) hanging_.add(k);
  });
  std::array<std::uint32_t, nodes_at_once> nodes;
  std::size_t count = 0;
  hanging_.each([&](std::uint32_t k) {
    nodes[count++] = k;
    if (count == nodes.size()) move_some({nodes.data(), std::exchange(count, 0)}, frame.points, spheres);
  });
  move_some({nodes.data(), count}, frame.points, spheres);

  const std::size_t tested = walk_.measure_again(frame.points, spheres, changed_leaves_, moved_, touched_);
  const bool rounding_changed = frame.rounding != rounding_;
  rounding_ = frame.rounding;
  // mutant changed-rounding-ignored: `rounding_changed` -> `false`
  if (rounding_changed)
    set_radii_of_all(spheres);
  else
    touched_.each([&](std::uint32_t k) { set_radius(k, rounding_, spheres); });
  return tested;
}

// Of at most nodes_at_once nodes, ascending: the centres, and how far those have come that have moved.
void ExactRule::move_some(std::span<const std::uint32_t> nodes, std::span<const LocalPoint> points,
                          std::span<Spheref> spheres) noexcept {
  if (nodes.empty()) return;
  std::array<LocalPoint, nodes_at_once> centers;
  anchors_.centers(nodes, points, centers.data());
  std::array<std::uint32_t, core_size * nodes_at_once> cores;
  std::array<float, nodes_at_once> radii;
  std::size_t most = 0;
  for (const std::uint32_t k : nodes) most = std::max(most, core_of(k).count);
  for (std::size_t j = 0; j < nodes_at_once; ++j) {
    const std::uint32_t k = nodes[std::min(j, nodes.size() - 1)];
    if (j >= nodes.size()) centers[j] = centers[nodes.size() - 1];
    radii[j] = core_radius_[lane_[k]];
    const auto [first, count] = core_of(k);
    // mutant changed-cores-of-other-lanes: `[nodes_at_once * i]` -> `[nodes_at_once * i / 2]`
    for (std::size_t i = 0; i < count; ++i) cores[nodes_at_once * i + j] = first[nodes_at_once * i];
    for (std::size_t i = count; i < most; ++i) cores[nodes_at_once * i + j] = *first;
  }
  kernels().pull_many(points.data(), cores.data(), most, radii.data(), centers.data());
  for (std::size_t j = 0; j < nodes.size(); ++j) {
    Vec3f& kept = spheres[walk_.nodes()[nodes[j]]].center;
    const Vec3f now{centers[j].x, centers[j].y, centers[j].z};
    // In double, where no square vanishes; the walk's bounds pay for narrowing it (corner_walk_again.cpp).
    // mutant moved-a-little-less: `distance` -> `0.98 * distance`
    if (now != kept) moved_.push_back({nodes[j], static_cast<float>(distance(Vec3(now), Vec3(kept)))});
    kept = now;
  }
}

}  // namespace morula::detail
