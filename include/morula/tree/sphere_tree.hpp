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
  bool nested = false;                     ///< a promise: every sphere contains its children's (tree/nesting.hpp)

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

}  // namespace morula
