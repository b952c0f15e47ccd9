// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nearest-first walk through one sphere tree, which prunes nodes that are too far. Queries for rays, shapes and insides
// use it.
#pragma once

#include <array>
#include <cassert>
#include <morula/tree/sphere_tree.hpp>

namespace morula {

/// Walks from the root to leaves, nearest child first; equal bounds go by index. Allocates nothing.
///
/// bound_of(node): a lower bound of the quantity in the node's region, in any unit. A bound of a node holds for
/// the nodes below it. limit(): nodes with a greater bound are pruned; it may fall during the walk. prune(bound):
/// called for every node that is pruned or not reached. visit(leaf, bound): returns false to end the walk.
/// Cost: one bound per child of each opened node.
template <class BoundOf, class Limit, class Leave, class Look>
void walk_nearest_first(const SphereTree& tree, const BoundOf& bound_of, const Limit& limit, const Leave& prune,
                        const Look& visit) {
  struct Waiting {
    double bound;
    std::uint32_t node;
  };
  // At most the siblings along one path wait, on max_depth levels.
  std::array<Waiting, max_depth * max_branching + 1> stack;
  std::size_t top = 0;
  stack[top++] = {bound_of(0), 0};
  while (top > 0) {
    const Waiting here = stack[--top];
    if (here.bound > limit()) {
      prune(here.bound);
      continue;
    }
    if (tree.is_leaf(here.node)) {
      if (visit(here.node, here.bound)) continue;
      while (top > 0) prune(stack[--top].bound);
      return;
    }
    const std::size_t bottom = top;
    const std::uint32_t first = tree.first_child[here.node];
    for (std::uint32_t child = first + tree.child_count[here.node]; child-- > first;) {
      const double own = bound_of(child), bound = own > here.bound ? own : here.bound;
      if (bound > limit()) {
        prune(bound);
        continue;
      }
      assert(top < stack.size());
      std::size_t at = top++;
      for (; at > bottom && stack[at - 1].bound < bound; --at) stack[at] = stack[at - 1];
      stack[at] = {bound, child};
    }
  }
}

}  // namespace morula
