// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/corner_walk.hpp"

#include <algorithm>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t leaves_per_chunk = 8;

}  // namespace

float SquaredReaches::farthest_entry(const CornerChains& chains, std::uint32_t k) const noexcept {
  const CornerChains::Below& below = chains.below(k);
  float farthest = 0;
  for (std::uint32_t leaf = below.leaf_begin; leaf < below.leaf_end; ++leaf)
    farthest = std::max(farthest, of_entry[chains.begin(leaf) + below.slot]);
  return farthest;
}

CornerWalk::CornerWalk(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
                       std::span<const std::uint8_t> measured)
    : chains_(tree, order, ownership, measured) {
  reaches_.of_entry.resize(chains_.entry_count());
  reaches_.of_node.resize(nodes().size());
}

void CornerWalk::measure_first(std::size_t count, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                               Workers& workers) noexcept {
  const Uninterrupted whole;
  parallel_for(workers, chains_.leaf_count(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    chains_.farthest_of_leaves(begin, end, count, points, spheres, reaches_.of_entry);
  });
  gather(count);
}

// Computes the reaches of the first `count` nodes from those of entries.
void CornerWalk::gather(std::size_t count) noexcept {
  const std::vector<float>& of_entry = reaches_.of_entry;
  std::vector<float>& of_node = reaches_.of_node;
  const std::span<const std::uint32_t> all_chains = chains_.chain();
  std::fill_n(of_node.begin(), count, 0.0f);
  const auto raise = [&](std::uint32_t k, float squared) {
    if (k < count) of_node[k] = std::max(of_node[k], squared);
  };
  // Most leaves have the same ancestors as the last leaf. For chains of four nodes, their maxima stay in a register.
  constexpr std::size_t together = 4;
  Float4 most(0.0f);
  const std::uint32_t* above = nullptr;  // the chain whose first three nodes these maxima belong to; null: none
  const auto finish = [&] {
    if (above == nullptr) return;
    const auto squared = most.lanes();
    for (std::size_t i = 0; i + 1 < together; ++i) raise(above[i], squared[i]);
    above = nullptr;
  };
  for (std::size_t leaf = 0; leaf < chains_.leaf_count(); ++leaf) {
    const std::size_t begin = chains_.begin(leaf), end = chains_.end(leaf);
    if (end - begin != together) {
      for (std::size_t entry = begin; entry < end; ++entry) raise(all_chains[entry], of_entry[entry]);
      continue;
    }
    const std::uint32_t* const chain = &all_chains[begin];
    const Float4 squared = Float4::load(&of_entry[begin]);
    if (above != nullptr && above[2] == chain[2]) {
      // mutant walk-reach-of-one-leaf: `max(most, squared)` -> `squared`
      most = max(most, squared);
    } else {
      finish();
      above = chain, most = squared;
    }
    raise(chain[3], of_entry[begin + 3]);
  }
  finish();
}

void CornerWalk::measure_one(std::uint32_t k, std::span<const LocalPoint> points,
                             std::span<const Spheref> spheres) noexcept {
  const CornerChains::Below& below = chains_.below(k);
  for (std::uint32_t leaf = below.leaf_begin; leaf < below.leaf_end; ++leaf) {
    const std::size_t entry = chains_.begin(leaf) + below.slot;
    reaches_.of_entry[entry] = chains_.farthest(leaf, entry, points, spheres);
  }
  reaches_.of_node[k] = reaches_.farthest_entry(chains_, k);
}

}  // namespace morula::detail
