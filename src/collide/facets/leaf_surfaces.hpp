// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The surface that the leaves of one body own, in the body's own coordinates: read once per leaf and batch of
// questions.
#pragma once

#include <cstdint>
#include <morula/collide/collider.hpp>
#include <optional>
#include <vector>

#include "collide/facets/facet_columns.hpp"

namespace morula::detail {

/// The share of each facet of each leaf that the leaf owns, in the order of the collider's lists. The same for all
/// questions about a body.
class FacetShares {
 public:
  bool is_of(const Collider& collider) const;
  /// Linear in patches where they are of another ownership, else constant.
  void follow(const Collider& collider);
  const float* data() const { return share_.data(); }

 private:
  std::uint64_t cover_id_ = 0;
  std::vector<float> share_;
};

class LeafSurfaces {
 public:
  /// Forgets all leaves, not the memory. shares: the collider's, which stay until the next start.
  void start(const Collider& collider, const FacetShares& shares);
  /// The same with shares of its own: linear in patches once per ownership, constant afterwards.
  void start(const Collider& collider) {
    own_shares_.follow(collider);
    start(collider, own_shares_);
  }
  const Collider* collider() const { return collider_; }

  struct Leaf {
    std::uint32_t begin = 0, size = 0;  ///< of slots, one per facet in the order of Collider::facets
    float extent = 0;                   ///< largest |coordinate| of a corner about `center`
    Vec3 center;                        ///< what the columns are about
    Vec3 area_vector;                   ///< of what the leaf owns: area times mean normal
    double area = 0;
    std::optional<double> standing_off{};  ///< of contact_surface.cpp, once it was asked for
  };
  /// A leaf, read if it has not been. The reference is good until the next batch.
  Leaf& read(std::uint32_t leaf);
  FacetColumns columns(const Leaf& leaf) const;
  std::uint32_t facet(const Leaf& leaf, std::size_t i) const { return facet_[leaf.begin + i]; }

  /// f(leaf) for the leaves below a node, or itself, in the order of their regions.
  template <class F>
  void for_leaves(std::uint32_t node, const F& f) {
    const SphereTree& tree = collider_->tree();
    if (tree.is_leaf(node)) return f(read(node));
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) for_leaves(tree.first_child[node] + k, f);
  }

 private:
  const Collider* collider_ = nullptr;
  FacetShares own_shares_;
  const float* share_ = nullptr;  // of each facet of each leaf
  std::vector<std::uint32_t> stamp_;
  std::vector<Leaf> leaf_;
  std::uint32_t now_ = 0;
  // Of a slot.
  std::vector<float> columns_[9];
  std::vector<std::uint32_t> facet_;
  std::size_t used_ = 0;
};

}  // namespace morula::detail
