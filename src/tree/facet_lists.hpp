// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The facets of which each node owns a part, and the shares of their areas.
#pragma once

#include <atomic>
#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/tree/covered_tree.hpp>
#include <span>
#include <vector>

namespace morula::detail {

/// Lists of facets that follow from a tree and its cover alone. All colliders over one cover share them.
class FacetLists {
 public:
  /// The cover must be of the tree. Cost: linear in patches.
  FacetLists(const SphereTree& tree, const Cover& cover);

  /// The lists of all leaves in the order of their regions, each list ascending and without repetitions.
  std::span<const std::uint32_t> facets() const { return facets_; }
  /// The list of a node is the range [begin, end) of facets().
  std::span<const std::uint32_t> begin() const { return begin_; }
  std::span<const std::uint32_t> end() const { return end_; }

  /// Copies the shares of a leaf: for each facet of its list, the share of the facet's area that the leaf owns, which
  /// is constant under any deformation. Cost of the first call for a leaf: linear in its patches. Several threads may
  /// call it at the same time. cover: that of the constructor, mesh_facets: the facets of its mesh.
  void copy_shares(std::uint32_t leaf, const Cover& cover, std::span<const Facet> mesh_facets,
                   std::vector<float>& shares) const;

 private:
  void find_shares(std::uint32_t leaf, const Cover& cover, std::span<const Facet> mesh_facets,
                   std::span<float> shares) const;

  std::vector<std::uint32_t> facets_, begin_, end_;
  // One per entry of facets_, `unknown` until find_shares(). Threads that compute the same leaf store the same bits.
  static constexpr float unknown = -1;
  mutable std::vector<std::atomic<float>> shares_;
};

}  // namespace morula::detail
