// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/self_tree.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace morula::detail {

SelfTree::SelfTree(std::span<const Facet> facets, std::span<const Vec3> world)
    : order_(facets.size()), boxes_(facets.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<Vec3> middles;
  for (const Facet& f : facets) middles.push_back(world[f[0]] / 3 + world[f[1]] / 3 + world[f[2]] / 3);
  split(middles, 0, static_cast<std::uint32_t>(facets.size()));
}

// Halves along the longest side of the box of all middles.
void SelfTree::split(std::vector<Vec3>& middles, std::uint32_t begin, std::uint32_t end) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({{}, 0, begin, end});
  if (end - begin <= 4) return;
  Box box;
  for (std::uint32_t i = begin; i < end; ++i) box.add(middles[order_[i]]);
  const int axis = box.longest_axis();
  const std::uint32_t half = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(half), at(end), [&](std::uint32_t p, std::uint32_t q) {
    return std::tie(middles[p][axis], p) < std::tie(middles[q][axis], q);
  });
  split(middles, begin, half);
  nodes_[node].second = static_cast<std::uint32_t>(nodes_.size());
  split(middles, half, end);
}

void SelfTree::update(std::span<const Facet> facets, std::span<const Vec3> world) {
  for (std::size_t i = 0; i < order_.size(); ++i) {
    boxes_[i] = {};
    for (const std::uint32_t v : facets[order_[i]]) boxes_[i].add(world[v]);
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    node.box = {};
    if (node.is_leaf()) {
      for (std::uint32_t i = node.begin; i < node.end; ++i) node.box.add(boxes_[i]);
    } else {
      node.box.add(nodes_[n + 1].box);
      node.box.add(nodes_[node.second].box);
    }
  }
}

}  // namespace morula::detail
