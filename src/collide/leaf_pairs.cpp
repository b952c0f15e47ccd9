// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Pads. A placement's matrix may stretch: |R Rᵀ - I| <= 1e-9 in each entry, so R stretches by less than 2e-9, and
// 2^-28 = 3.7e-9. Let c be a sphere's centre in mesh coordinates, r its radius, t the translation, all by their largest
// coordinate, e = 2^-53. A point of the sphere has coordinates up to c + r, a row of R a sum of absolute entries below
// 2, so R x + t is rounded by less than 4 e (2 (c + r) + t) in each coordinate, below 14 e (c + r + t) as a length, and
// so is the centre: 28 e. Allowed: 2^-48 = 32 e. What is left covers the distance's own rounding, 3 e of the radii.
#include "collide/leaf_pairs.hpp"

namespace morula {
namespace {

/// A node's sphere in the world, with a radius that is up to what rounding did.
Sphere placed(const Collider& body, std::uint32_t node) {
  const Sphere s = body.body().sphere(node);
  const double reach = largest_component(s.center) + s.radius + largest_component(body.placement().translation);
  return {body.placement()(s.center), s.radius * (1 + 0x1p-28) + reach * 0x1p-48};
}

}  // namespace

void overlapping_leaves(const Collider& a, const Collider& b, std::vector<NodePair>& stack,
                        std::vector<NodePair>& leaves) {
  const SphereTree &tree_a = a.body().rest_tree(), &tree_b = b.body().rest_tree();
  stack.assign(1, {0, 0});
  while (!stack.empty()) {
    const NodePair pair = stack.back();
    stack.pop_back();
    const Sphere sphere_a = placed(a, pair.a), sphere_b = placed(b, pair.b);
    // Only a comparison that surely says "apart" prunes; coordinates near the end of the range make it NaN.
    if (distance(sphere_a.center, sphere_b.center) > sphere_a.radius + sphere_b.radius) continue;
    const bool leaf_a = tree_a.is_leaf(pair.a), leaf_b = tree_b.is_leaf(pair.b);
    if (leaf_a && leaf_b) {
      leaves.push_back(pair);
    } else if (leaf_b || (!leaf_a && sphere_a.radius >= sphere_b.radius)) {
      for (std::uint32_t k = 0; k < tree_a.child_count[pair.a]; ++k)
        stack.push_back({tree_a.first_child[pair.a] + k, pair.b});
    } else {
      for (std::uint32_t k = 0; k < tree_b.child_count[pair.b]; ++k)
        stack.push_back({pair.a, tree_b.first_child[pair.b] + k});
    }
  }
}

}  // namespace morula
