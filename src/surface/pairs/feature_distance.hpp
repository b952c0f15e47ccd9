// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nearest points of two features.
#pragma once

#include <morula/surface/proximity.hpp>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

/// Of a pair of vertex and facet, either way round, or of two edges. points: 1 and 3, 3 and 1, or 2 and 2.
ProximityPair nearest_points(const FeaturePair& pair, std::span<const Vec3> a, std::span<const Vec3> b);
/// Are two features of one surface within a distance at rest? Of two facets, that of their vertices, edges and facets
/// counts which is least: 0 where they cross.
bool are_within_at_rest(const SurfaceTreeState& s, const FeaturePair& pair, double distance);

}  // namespace morula::detail
