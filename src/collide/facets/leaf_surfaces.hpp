// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The surface that the leaves of one body own, in the body's own coordinates: read once per leaf and batch of queries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/collide/collider.hpp>
#include <morula/geometry/vector.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula::detail {

/// Corners of many facets in columns of floats: corner k of facet i is (column[3 k][i], column[3 k + 1][i], column[3 k
/// + 2][i]). count: a multiple of facet_columns_step, filled up with repetitions of a facet.
struct FacetColumns {
  const float* column[9];
  std::size_t count;
};
inline constexpr std::size_t facet_columns_step = 16;

/// All give the same bits: the same operations in the same order, none of them fused.
struct FacetKernels {
  /// squared[i] = squared distance of p from the box of facet i; room for count. Returns the least.
  float (*squared_gaps)(const FacetColumns& facets, const Vec3f& p, float* squared);
  /// A mask of facet_columns_step numbers: bit i is set if number i is at most `limit`.
  unsigned (*at_most)(const float* numbers, float limit);
  /// Largest corner . direction. count > 0.
  float (*reach)(const FacetColumns& facets, const Vec3f& direction);
};
/// The kernels that this processor runs, the narrowest first.
std::span<const FacetKernels> all_facet_kernels();
/// The widest kernels.
const FacetKernels& facet_kernels();

/// The share of each facet of each leaf that the leaf owns, in the order of the collider's lists. They are the same for
/// all queries of a body.
class FacetShares {
 public:
  bool is_of(const Collider& collider) const;
  /// Fills the shares for the collider's cover. Cost: linear in patches if the shares are of another cover, else
  /// constant.
  void follow(const Collider& collider);
  const float* data() const { return share_.data(); }

 private:
  std::uint64_t cover_id_ = 0;
  std::vector<float> share_;
};

class LeafSurfaces {
 public:
  /// Forgets all leaves and keeps the memory. shares: the collider's, which have to stay until the next start.
  void start(const Collider& collider, const FacetShares& shares);
  /// The same with shares of its own: linear in patches once per cover, constant afterwards.
  void start(const Collider& collider) {
    own_shares_.follow(collider);
    start(collider, own_shares_);
  }
  const Collider* collider() const { return collider_; }

  struct Leaf {
    std::uint32_t begin = 0, size = 0;  ///< range of slots, one per facet in the order of Collider::facets
    float extent = 0;                   ///< largest |coordinate| of a corner about `center`
    Vec3 center;                        ///< origin of the columns' coordinates
    Vec3 area_vector;                   ///< area of the leaf's region times its mean normal
    double area = 0;
    std::optional<double> standing_off{};  ///< standing_off() of contact_surface.cpp; none until it is computed
  };
  /// A leaf; reads it on first use. The reference is valid until the next batch.
  Leaf& read(std::uint32_t leaf);
  FacetColumns columns(const Leaf& leaf) const;
  std::uint32_t facet(const Leaf& leaf, std::size_t i) const { return facet_[leaf.begin + i]; }

  /// Calls f(leaf) for the leaves below a node, or for the node itself if it is a leaf, in the order of their regions.
  template <class F>
  void for_leaves(std::uint32_t node, const F& f) {
    const SphereTree& tree = collider_->tree();
    if (tree.is_leaf(node)) return f(read(node));
    for (std::uint32_t k = 0; k < tree.child_count[node]; ++k) for_leaves(tree.first_child[node] + k, f);
  }

 private:
  const Collider* collider_ = nullptr;
  FacetShares own_shares_;
  const float* share_ = nullptr;  // by facet of each leaf
  std::vector<std::uint32_t> stamp_;
  std::vector<Leaf> leaf_;
  std::uint32_t now_ = 0;
  // By slot.
  std::vector<float> columns_[9];
  std::vector<std::uint32_t> facet_;
  std::size_t used_ = 0;
};

}  // namespace morula::detail
