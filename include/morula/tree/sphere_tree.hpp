// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The sphere tree: a few flat arrays, level by level, that know nothing of meshes, files or threads.
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

/// Nodes are numbered level by level from the root (0); the children of a node are adjacent, and nodes of a level are
/// in the order of their parents.
struct SphereTree {
  std::vector<Sphere> spheres;             ///< one per node, mesh units
  std::vector<std::uint32_t> first_child;  ///< no_node for a leaf
  std::vector<std::uint32_t> child_count;  ///< 0 for a leaf, at most branching
  std::vector<std::uint32_t> parent;       ///< no_node for the root
  std::vector<std::uint32_t> level_begin;  ///< level j holds nodes [level_begin[j], level_begin[j + 1])
  std::uint32_t branching = 8;             ///< most children of a node, 2…64
  bool nested = false;  ///< a promise: every sphere contains its children's; certify_nesting checks it

  std::size_t node_count() const { return spheres.size(); }
  /// Depth + 1; 0 for a tree without nodes.
  std::size_t level_count() const { return level_begin.empty() ? 0 : level_begin.size() - 1; }
  bool is_leaf(std::uint32_t node) const { return child_count[node] == 0; }
  std::size_t leaf_count() const;
  std::uint32_t level_of(std::uint32_t node) const;

  /// Adds a level of nodes: child_counts[k] children for the k-th node of the present last level. Used by builders and
  /// readers; keeps every invariant. Returns the first new node.
  std::uint32_t append_level(std::span<const std::uint32_t> child_counts, std::span<const Sphere> new_spheres);
};

/// Level set j: the nodes of level j and the leaves that ended above it, ascending. These are what covers the surface
/// at resolution j. Throws std::invalid_argument for a level that the tree has not: an automatic depth may be less than
/// expected.
std::vector<std::uint32_t> level_set(const SphereTree& tree, std::size_t level);

/// The spheres of level set j, taken from `spheres` (one per node; the tree's own by default).
std::vector<Sphere> level_set_spheres(const SphereTree& tree, std::size_t level);
std::vector<Sphere> level_set_spheres(const SphereTree& tree, std::span<const Sphere> spheres, std::size_t level);

/// What is wrong with the arrays, in words; empty when every invariant above holds, all numbers are finite,
/// and a tree that says it is nested is.
std::vector<std::string> validate(const SphereTree& tree);

/// 64-bit FNV-1a over all arrays.
std::uint64_t tree_hash(const SphereTree& tree);

/// A bare tree over balls that have none, such as a flat set or medial balls: its leaves are the balls, each once, in
/// an order of their own. A node's sphere contains the balls below it; nodes are divided where their balls' centers lie
/// farthest apart.
///
/// branching: 2…64. After: validate() finds nothing. Cost: O(n log² n). The same bits everywhere. Throws
/// std::invalid_argument for no balls, for more than the levels up to max_depth hold (16 million at branching 8), and
/// for numbers that are not finite, negative radii, and balls so large that no sphere around them is finite.
SphereTree tree_from_spheres(std::span<const Sphere> balls, std::uint32_t branching = 8);

// Nesting: every sphere contains its children's spheres, for engines that prune that way.

/// The certificate of nesting.
struct [[nodiscard]] Nesting {
  bool nested = true;
  std::size_t outside = 0;  ///< spheres that stick out of their parent's
  double worst_excess = 0;  ///< largest |c - c'| + r' - r of those asked, rounded; at most 0 exactly when nested
  std::uint32_t worst_node = no_node;  ///< the child
};

/// Does every sphere contain its children's? Exact: the answer is that of the real numbers, for all finite ones.
///
/// spheres: one per node of the tree, at rest or moved; radii at least 0. A number that is not finite counts as
/// outside. parents: one flag per node, which of them to ask; all where there are none. Cost: linear in nodes. Throws
/// std::invalid_argument for another number of spheres or flags.
Nesting certify_nesting(const SphereTree& tree, std::span<const Sphere> spheres,
                        std::span<const std::uint8_t> parents = {});

/// Makes inner spheres contain their children's, from the deepest level up, and sets tree.nested.
///
/// Leaves stay as they are. A sphere that contains its children's stays, unless the smallest sphere around these is
/// smaller; any other becomes the smaller of {same center, larger radius} and {smallest sphere around the children's},
/// with radii rounded up. So what a node's leaves contain its sphere contains: a tree that covers still does, with the
/// pads that certify() asks for. Throws std::invalid_argument, and changes nothing, for a tree that fails validate(),
/// or when no sphere around some children is finite.
void make_nested(SphereTree& tree);

}  // namespace morula
