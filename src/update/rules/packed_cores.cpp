// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/packed_cores.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace morula::detail {

PackedCores::PackedCores(std::span<const std::uint32_t> cores, std::span<const float> radii,
                         std::span<const std::uint32_t> levels) {
  const std::size_t node_count = radii.size();
  // Each point once, in the order of the list, which decides among equals.
  std::vector<std::vector<std::uint32_t>> core_of(node_count);
  for (std::size_t k = 0; k < node_count; ++k)
    for (const std::uint32_t p : cores.subspan(core_size * k, core_size))
      if (std::find(core_of[k].begin(), core_of[k].end(), p) == core_of[k].end()) core_of[k].push_back(p);

  lane_.resize(node_count);
  std::vector<std::uint32_t> order;
  for (std::size_t begin = 0; begin < node_count; begin += nodes_per_chunk) {
    order.resize(std::min(nodes_per_chunk, node_count - begin));
    std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
    // Sorted by level first: an update of upper levels alone takes the first groups.
    const auto key = [&](std::uint32_t k) { return std::tuple(levels[k], core_of[k].size(), k); };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (std::size_t first = 0; first < order.size(); first += nodes_at_once)
      append_group(std::span(order).subspan(first, std::min(nodes_at_once, order.size() - first)), core_of, radii);
  }
}

void PackedCores::append_group(std::span<const std::uint32_t> nodes,
                               std::span<const std::vector<std::uint32_t>> core_of, std::span<const float> radii) {
  std::size_t count = 0;
  for (std::size_t j = 0; j < nodes_at_once; ++j) {
    const std::uint32_t k = nodes[std::min(j, nodes.size() - 1)];
    if (j < nodes.size()) lane_[k] = static_cast<std::uint32_t>(node_of_lane_.size());
    node_of_lane_.push_back(k);
    rest_radius_.push_back(radii[k]);
    count = std::max(count, core_of[k].size());
  }
  const auto lanes = std::span(node_of_lane_).last(nodes_at_once);
  for (std::size_t i = 0; i < count; ++i)
    for (const std::uint32_t k : lanes) points_.push_back(core_of[k][i < core_of[k].size() ? i : 0]);
  begin_.push_back(static_cast<std::uint32_t>(points_.size()));
}

}  // namespace morula::detail
