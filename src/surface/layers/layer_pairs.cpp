// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/layers/layer_pairs.hpp"

#include <algorithm>
#include <tuple>

#include "parallel/interruptible_sort.hpp"

namespace morula::detail {

void LayerPartners::start(std::span<const FeaturePair> pairs, int end, std::size_t facet_count) {
  partners_.clear();
  runs_.clear();
  run_of_.resize(std::max(run_of_.size(), facet_count), 0);
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    if (end != 1) partners_.push_back({pairs[i].a, pairs[i].b, i, 0});
    if (end != 0) partners_.push_back({pairs[i].b, pairs[i].a, i, 1});
  }
  if (end != 0)
    sort_interruptibly(partners_, [](const Partner& p, const Partner& q) {
      return std::tie(p.facet, p.partner) < std::tie(q.facet, q.partner);
    });
  for (std::uint32_t i = 0; i < partners_.size(); ++i) {
    if (runs_.empty() || runs_.back().facet != partners_[i].facet) {
      run_of_[partners_[i].facet] = static_cast<std::uint32_t>(runs_.size());
      runs_.push_back({partners_[i].facet, i, i});
    }
    runs_.back().end = i + 1;
  }
}

std::uint32_t LayerGroups::root(std::uint32_t node) {
  while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
  return node;
}

void LayerGroups::unite(std::uint32_t i, std::uint32_t j) {
  i = root(i), j = root(j);
  if (i != j) parent_[std::max(i, j)] = std::min(i, j);
}

void LayerGroups::unite_partners(std::span<const std::uint8_t> is_near, const LayerPartners& of,
                                 const LayerMesh& partners, bool is_with_itself) {
  last_node_.resize(std::max(last_node_.size(), partners.vertex_count()), 0);
  last_run_.resize(last_node_.size(), 0);
  InterruptPoller poll_interrupt(1024);
  for (const LayerPartners::Run& run : of.runs()) {
    ++run_;
    for (const LayerPartners::Partner& p : of.partners(run)) {
      poll_interrupt();
      if (!is_near[p.number]) continue;
      const std::uint32_t node = 2 * p.number + (is_with_itself ? p.end : 0);
      for (const std::uint32_t v : partners.corners(p.partner)) {
        if (last_run_[v] == run_) {
          unite(node, last_node_[v]);
          if (is_with_itself) unite(node ^ 1, last_node_[v] ^ 1);
        }
        last_run_[v] = run_, last_node_[v] = node;
      }
    }
  }
}

void LayerGroups::find(std::span<const std::uint8_t> is_near, const LayerPartners& of_a, const LayerMesh& a,
                       const LayerPartners& of_b, const LayerMesh& b) {
  const bool is_with_itself = &a == &b;
  const auto count = static_cast<std::uint32_t>(is_near.size());
  parent_.resize(2 * count);
  for (std::uint32_t i = 0; i < 2 * count; ++i) parent_[i] = i;
  unite_partners(is_near, of_a, b, is_with_itself);
  if (!is_with_itself) unite_partners(is_near, of_b, a, false);
  places_.assign(count, {});
  patch_of_root_.assign(2 * count, none);
  patch_count_ = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!is_near[i]) continue;
    const std::uint32_t here = root(2 * i), mirrored = root(2 * i + 1);
    if (patch_of_root_[here] != none) {
      places_[i] = {patch_of_root_[here], false};
    } else if (is_with_itself && patch_of_root_[mirrored] != none) {
      places_[i] = {patch_of_root_[mirrored], true};
    } else {
      places_[i] = {patch_of_root_[here] = static_cast<std::uint32_t>(patch_count_++), false};
    }
  }
}

}  // namespace morula::detail
