// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The pairs of leaves whose spheres meet: a plain descent from the roots, for queries that are given no pairs.
#pragma once

#include <morula/collide/collider.hpp>
#include <morula/collide/node_pair.hpp>
#include <vector>

namespace morula {

/// Appends to `leaves` every pair of leaves whose spheres, and all pairs of spheres that lead to them, meet or nearly
/// do: never misses one whose regions, placed and rounded as Collider::vertex does, have a point in common. stack:
/// memory. Both bodies current.
void overlapping_leaves(const Collider& a, const Collider& b, std::vector<NodePair>& stack,
                        std::vector<NodePair>& leaves);

}  // namespace morula
