// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The surface that the leaves of one body own, in the body's own coordinates: read once per leaf and batch of queries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
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

class LeafSurfaces {
 public:
  /// Forgets all leaves and keeps the memory.
  void start(const Collider& collider);
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
  struct Entry {
    std::uint32_t node = 0, batch = 0, leaf = 0;  // leaf: index in leaves_
  };
  Entry& entry_of(std::uint32_t node);
  void grow();

  const Collider* collider_ = nullptr;
  // The leaves that were read, found by node: memory follows the leaves of a batch, not those of the tree.
  std::vector<Entry> table_ = std::vector<Entry>(64);  // size is a power of two, at most half of it used
  std::deque<Leaf> leaves_;                            // references stay valid while leaves are added
  std::size_t leaf_count_ = 0;                         // leaves of this batch, the first ones
  std::uint32_t now_ = 0;                              // number of the batch
  // By slot.
  std::vector<float> columns_[9];
  std::vector<std::uint32_t> facet_;
  std::size_t used_ = 0;
  std::vector<float> share_;  // the share of each facet's area that the leaf being read owns
};

}  // namespace morula::detail
