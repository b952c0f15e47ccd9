// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ownership check: whether every node tests enough of its corners, by other means than those that chose them.
#pragma once

#include <string>
#include <vector>

#include "update/points/ownership.hpp"

namespace morula::detail {

/// Returns every violated promise as text; empty if, for every node whose leaves need cut points and every facet, each
/// corner that the node owns lies within `tolerance` (in |x| + |y| of the facet's weights; twice that above leaves) of
/// the convex hull of the corners that it tests, and every node tests all leaves below it. Debug builds check every
/// body.
///
/// A corner outside a hull is separated from it by a line: the direction from the nearest vertex of the hull, or
/// perpendicular to its nearest edge. So all these directions are tried, between all pairs of tested corners, in
/// extended precision. Cost per node, facet and corner left out: the cube of the corners that the node tests there.
std::vector<std::string> ownership_faults(const MeshView& mesh, const SphereTree& tree, const Cover& cover,
                                          const LeafOrder& order, const Ownership& ownership,
                                          std::span<const std::uint8_t> needs_cut_points, double tolerance);

}  // namespace morula::detail
