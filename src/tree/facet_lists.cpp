// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "tree/facet_lists.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace morula::detail {
namespace {

/// A corner's barycentric coordinates in its facet, without that of the facet's first corner.
std::array<double, 2> place_in(const Facet& facet, const Cover& cover, std::uint32_t corner) {
  std::array<double, 2> place{};
  const auto add = [&](std::uint32_t vertex, double weight) {
    if (vertex == facet[0]) return;
    if (vertex == facet[1])
      place[0] += weight;
    else if (vertex == facet[2])
      place[1] += weight;
  };
  if (corner < cover.vertex_count) {
    add(corner, 1);
  } else {
    const CutPoint& point = cover.cut_points[corner - cover.vertex_count];
    for (std::size_t k = 0; k < 3; ++k) add(point.vertex[k], point.weight[k]);
  }
  return place;
}

/// The area of a patch as a share of its facet; it is constant under any deformation. A whole facet, by far the most
/// frequent patch, needs no sum: the formula below gives 1 for it.
double share_of(const Facet& facet, const Cover& cover, std::size_t patch) {
  const std::span<const std::uint32_t> corners = cover.patch(patch);
  if (corners.size() == 3 && std::max({corners[0], corners[1], corners[2]}) < cover.vertex_count) return 1;
  double share = 0;
  std::array<double, 2> last = place_in(facet, cover, corners.back());
  for (const std::uint32_t corner : corners) {
    const std::array<double, 2> next = place_in(facet, cover, corner);
    share += last[0] * next[1] - last[1] * next[0];
    last = next;
  }
  return std::clamp(std::abs(share), 0.0, 1.0);
}

}  // namespace

FacetLists::FacetLists(const SphereTree& tree, const Cover& cover)
    : begin_(tree.node_count(), 0), end_(tree.node_count(), 0) {
  // Patches are in depth-first order of leaves: so are the lists, and the list of an inner node is one range.
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    if (tree.is_leaf(node)) leaves.push_back(node);
  std::stable_sort(leaves.begin(), leaves.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return cover.region_begin[a] < cover.region_begin[b]; });
  for (const std::uint32_t leaf : leaves) {
    const auto begin = static_cast<std::ptrdiff_t>(facets_.size());
    facets_.insert(facets_.end(), cover.patch_facet.begin() + cover.region_begin[leaf],
                   cover.patch_facet.begin() + cover.region_end[leaf]);
    std::sort(facets_.begin() + begin, facets_.end());
    facets_.erase(std::unique(facets_.begin() + begin, facets_.end()), facets_.end());
    begin_[leaf] = static_cast<std::uint32_t>(begin);
    end_[leaf] = static_cast<std::uint32_t>(facets_.size());
  }
  for (std::uint32_t node = static_cast<std::uint32_t>(tree.node_count()); node-- > 0;) {
    if (tree.is_leaf(node)) continue;
    begin_[node] = begin_[tree.first_child[node]];
    end_[node] = end_[tree.first_child[node] + tree.child_count[node] - 1];
  }
  shares_ = std::vector<std::atomic<float>>(facets_.size());
  for (std::atomic<float>& share : shares_) share.store(unknown, std::memory_order_relaxed);
}

// Patches of a leaf are mostly in the order of its list.
void FacetLists::find_shares(std::uint32_t leaf, const Cover& cover, std::span<const Facet> mesh_facets,
                             std::span<float> shares) const {
  const std::span<const std::uint32_t> facets = std::span(facets_).subspan(begin_[leaf], shares.size());
  std::fill(shares.begin(), shares.end(), 0.0f);
  std::size_t entry = 0;
  for (std::uint32_t patch = cover.region_begin[leaf]; patch < cover.region_end[leaf]; ++patch) {
    const std::uint32_t facet = cover.patch_facet[patch];
    if (entry == facets.size() || facets[entry] != facet)
      entry = static_cast<std::size_t>(std::lower_bound(facets.begin(), facets.end(), facet) - facets.begin());
    shares[entry++] += static_cast<float>(share_of(mesh_facets[facet], cover, patch));
  }
  for (std::size_t i = 0; i < shares.size(); ++i) shares_[begin_[leaf] + i].store(shares[i], std::memory_order_relaxed);
}

void FacetLists::copy_shares(std::uint32_t leaf, const Cover& cover, std::span<const Facet> mesh_facets,
                             std::vector<float>& shares) const {
  const std::uint32_t first = begin_[leaf];
  shares.resize(end_[leaf] - first);
  // Another thread may have stored some of the leaf's shares only.
  bool all_known = true;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    shares[i] = shares_[first + i].load(std::memory_order_relaxed);
    all_known = all_known && shares[i] != unknown;
  }
  if (!all_known) find_shares(leaf, cover, mesh_facets, shares);
}

std::shared_ptr<const FacetLists> SharedFacetLists::get(const SphereTree& tree, const Cover& cover) const {
  const std::lock_guard lock(mutex_);
  if (!made_) made_ = std::make_shared<const FacetLists>(tree, cover);
  return made_;
}

}  // namespace morula::detail
