// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Monotone: no level takes in more empty space than the level above it.
#pragma once

#include "generators/driver/top_down.hpp"
#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Takes back what does not pay of a new level, then whatever is needed until the level, as a whole, is not looser than
/// the level above, as far as UnionLines can tell, and by more than their error.
///
/// settled: spheres of leaves on levels above. above: nodes of the level above that were divided, or tried to be. next:
/// the new level, after all exchange. On the last level a division is taken back by leaving its node a leaf, which owns
/// what its children owned; they are erased from `next`, and its region is put together again. On other levels, where
/// the places are needed below, and below the root, its children keep their regions and get spheres inside the node's
/// own. A level of which everything is taken back is the level above, or inside it: so there is always an end. pad: for
/// rounding radii up.
void keep_monotone(const Mesh& mesh, const ObjectLines& lines, double pad, std::span<const Sphere> settled,
                   std::vector<BuildNode>& above, std::vector<BuildNode>& next, bool last);

}  // namespace morula::detail
