// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The sphere tree: a few flat arrays, level by level, independent of meshes, files and threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <string>
#include <vector>

namespace morula {

inline constexpr std::uint32_t no_node = 0xffffffffu;
inline constexpr int max_branching = 64;
inline constexpr int max_depth = 8;

/// Nodes are numbered level by level from the root (0). The children of a node are adjacent, and the nodes of a level
/// are in the order of their parents.
struct SphereTree {
  std::vector<Sphere> spheres;             ///< one per node, mesh units
  std::vector<std::uint32_t> first_child;  ///< no_node for a leaf
  std::vector<std::uint32_t> child_count;  ///< 0 for a leaf, at most branching
  std::vector<std::uint32_t> parent;       ///< no_node for the root
  std::vector<std::uint32_t> level_begin;  ///< level j holds nodes [level_begin[j], level_begin[j + 1])
  std::uint32_t branching = 8;             ///< largest number of children of a node, 2…64
  bool nested = false;  ///< guarantee: every sphere contains its children's; certify_nesting checks it

  std::size_t node_count() const { return spheres.size(); }
  /// Depth + 1; 0 for a tree without nodes.
  std::size_t level_count() const { return level_begin.empty() ? 0 : level_begin.size() - 1; }
  bool is_leaf(std::uint32_t node) const { return child_count[node] == 0; }
  std::size_t leaf_count() const;
  std::uint32_t level_of(std::uint32_t node) const;

  /// Appends a level of nodes: child_counts[k] children for the k-th node of the present last level. Builders and
  /// readers use it; it keeps every invariant. Returns the first new node.
  std::uint32_t append_level(std::span<const std::uint32_t> child_counts, std::span<const Sphere> new_spheres);
};

/// Level set j: the nodes of level j and the leaves above it, ascending. These nodes cover the surface at resolution j.
/// Throws std::invalid_argument for a level that the tree does not have; an automatic depth may be less than expected.
std::vector<std::uint32_t> level_set(const SphereTree& tree, std::size_t level);

/// The spheres of level set j, from `spheres` (one per node; by default the tree's own).
std::vector<Sphere> level_set_spheres(const SphereTree& tree, std::size_t level);
std::vector<Sphere> level_set_spheres(const SphereTree& tree, std::span<const Sphere> spheres, std::size_t level);

/// The faults of the arrays, as text; empty if every invariant above holds, all numbers are finite, and a tree with
/// `nested` set is nested.
std::vector<std::string> validate(const SphereTree& tree);

/// 64-bit FNV-1a over all arrays.
std::uint64_t tree_hash(const SphereTree& tree);

/// A tree without a cover over given balls, such as a flat set or medial balls. Its leaves are the balls, each once, in
/// an order of their own. A node's sphere contains the balls below it; nodes are divided along the axis where the
/// centers of their balls lie farthest apart.
///
/// branching: 2…64. Result: validate() finds nothing, and the bits are the same on all machines. Cost: O(n log² n).
/// Throws std::invalid_argument for no balls, for more balls than the levels up to max_depth hold (16 million at
/// branching 8), for numbers that are not finite, for negative radii, and for balls so large that no sphere around them
/// is finite.
SphereTree tree_from_spheres(std::span<const Sphere> balls, std::uint32_t branching = 8);

// Nesting: every sphere contains its children's spheres, for engines that prune by it.

/// The certificate of nesting.
struct [[nodiscard]] Nesting {
  bool nested = true;
  std::size_t outside = 0;  ///< spheres that stick out of their parent's
  /// Largest |c - c'| + r' - r of the checked spheres, rounded, mesh units; at most 0 exactly if nested.
  double worst_excess = 0;
  std::uint32_t worst_node = no_node;  ///< the child with the largest excess
};

/// Checks that every sphere contains its children's. The result is exact for all finite numbers.
///
/// spheres: one per node of the tree, at rest or moved, with radii of at least 0. A number that is not finite counts as
/// outside. parents: one flag per node that selects the parents to check; empty checks all. Cost: linear in nodes.
/// Throws std::invalid_argument for another number of spheres or flags.
Nesting certify_nesting(const SphereTree& tree, std::span<const Sphere> spheres,
                        std::span<const std::uint8_t> parents = {});

/// Makes inner spheres contain their children's, from the deepest level up, and sets tree.nested.
///
/// Leaves stay unchanged. A sphere that contains its children's stays, unless the smallest sphere around these is
/// smaller. Any other sphere becomes the smaller of {same center, larger radius} and {smallest sphere around the
/// children's}, with radii rounded up. So a node's sphere contains all that its leaves contain: a tree that covers
/// still covers, with the pads that certify() requires. Throws std::invalid_argument, and changes nothing, for a tree
/// that fails validate(), or if no sphere around the children of a node is finite.
void make_nested(SphereTree& tree);

}  // namespace morula
