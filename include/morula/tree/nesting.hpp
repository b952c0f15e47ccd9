// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nesting: trees in which every sphere contains its children's spheres, for engines that prune that way.
#pragma once

#include <morula/tree/sphere_tree.hpp>
#include <span>

namespace morula {

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
