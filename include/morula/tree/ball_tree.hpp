// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A tree over balls that have none: a flat set, medial balls.
#pragma once

#include <morula/tree/sphere_tree.hpp>

namespace morula {

/// A bare tree whose leaves are the balls, each once, in an order of their own. A node's sphere contains the balls
/// below it; nodes are divided where their balls' centers lie farthest apart.
///
/// branching: 2…64. After: validate() finds nothing. Cost: O(n log² n). The same bits everywhere. Throws
/// std::invalid_argument for no balls, for more than the levels up to max_depth hold (16 million at branching 8), and
/// for numbers that are not finite, negative radii, and balls so large that no sphere around them is finite.
SphereTree tree_from_spheres(std::span<const Sphere> balls, std::uint32_t branching = 8);

}  // namespace morula
