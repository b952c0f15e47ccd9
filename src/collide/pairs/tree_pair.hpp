// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tree of node pairs of two bodies: the pairs that a traversal visits, and their tests.
//
// The root is the pair of roots. A pair opens into all pairs of children; if one node is final (a leaf, or on the
// requested level), into the pairs of it with the other's children. So a pair at depth k consists of nodes of the level
// sets k of both bodies.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <morula/collide/collider.hpp>

#include "collide/pairs/pair_kernels.hpp"

namespace morula::detail {

/// A range of adjacent nodes.
struct NodeRange {
  std::uint32_t first, count;
};

class TreePair {
 public:
  /// level: the level at which nodes are final; larger than both depths for the leaves.
  TreePair(const Collider& a, const Collider& b, double margin, std::uint32_t level)
      : placed_(placed_pair(a, b, margin)),
        spheres_a_(a.sphere_state().spheres),
        spheres_b_(b.sphere_state().spheres),
        tree_a_(&a.tree()),
        tree_b_(&b.tree()),
        level_(level) {}

  bool opens_a(std::uint32_t a, std::uint32_t depth) const { return depth < level_ && tree_a_->child_count[a] > 0; }
  bool opens_b(std::uint32_t b, std::uint32_t depth) const { return depth < level_ && tree_b_->child_count[b] > 0; }
  bool is_final(std::uint32_t a, std::uint32_t b, std::uint32_t depth) const {
    return !opens_a(a, depth) && !opens_b(b, depth);
  }
  /// The ranges into which a pair at this depth that is not final opens: all nodes below a with all nodes below b.
  NodeRange below_a(std::uint32_t a, std::uint32_t depth) const { return below(*tree_a_, a, opens_a(a, depth)); }
  NodeRange below_b(std::uint32_t b, std::uint32_t depth) const { return below(*tree_b_, b, opens_b(b, depth)); }

  /// Computes one mask per node of b.
  void test(NodeRange a, NodeRange b, std::uint64_t* masks) const {
    pair_kernels().test(placed_.narrow, block(a, b), masks);
  }
  /// Computes the same masks. Returns a length by which the sum of the changes of centers and radii of a pair may grow
  /// without changing a verdict, rounding aside; see PairKernels.
  double test_and_measure(NodeRange a, NodeRange b, std::uint64_t* masks) const {
    const double least = pair_kernels().test_and_measure(placed_.narrow, block(a, b), masks);
    // mutant front-clearance: `0.5 * least) * (1 - 0x1p-10` -> `least`
    return std::sqrt(0.5 * least) * (1 - 0x1p-10);
  }
  bool overlaps(std::uint32_t a, std::uint32_t b) const {
    std::uint64_t mask;
    test({a, 1}, {b, 1}, &mask);
    return mask != 0;
  }

  const PlacedPair& placed() const { return placed_; }
  const Spheref& sphere_a(std::uint32_t node) const { return spheres_a_[node]; }
  const Spheref& sphere_b(std::uint32_t node) const { return spheres_b_[node]; }
  /// The largest depth of a final pair.
  std::uint32_t depth() const {
    return std::min(level_, static_cast<std::uint32_t>(std::max(tree_a_->level_count(), tree_b_->level_count()) - 1));
  }

 private:
  static NodeRange below(const SphereTree& tree, std::uint32_t node, bool opens) {
    return opens ? NodeRange{tree.first_child[node], tree.child_count[node]} : NodeRange{node, 1};
  }
  PairBlock block(NodeRange a, NodeRange b) const {
    return {&spheres_a_[a.first], a.count, spheres_a_.size() - a.first,
            &spheres_b_[b.first], b.count, spheres_b_.size() - b.first};
  }

  PlacedPair placed_;
  std::span<const Spheref> spheres_a_, spheres_b_;
  const SphereTree *tree_a_, *tree_b_;
  std::uint32_t level_;
};

inline constexpr std::uint32_t leaf_level = std::numeric_limits<std::uint32_t>::max();

/// Calls f(node of a, node of b) for every pair that overlaps by the masks of these ranges, ascending by b, then by a,
/// until it returns true. Returns whether it did.
template <class F>
bool any_overlapping(NodeRange a, NodeRange b, const std::uint64_t* masks, const F& f) {
  for (std::uint32_t j = 0; j < b.count; ++j)
    for (std::uint64_t left = masks[j]; left != 0; left &= left - 1)
      if (f(a.first + static_cast<std::uint32_t>(std::countr_zero(left)), b.first + j)) return true;
  return false;
}

}  // namespace morula::detail
