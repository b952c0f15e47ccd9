// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nearest points of two features.
#pragma once

#include <morula/surface/proximity.hpp>

#include "surface/boxes/tree_state.hpp"

namespace morula::detail {

/// Of a pair of vertex and facet, either way round, or of two edges. points: 1 and 3, 3 and 1, or 2 and 2.
ProximityPair nearest_points(const FeaturePair& pair, std::span<const Vec3> a, std::span<const Vec3> b);
/// Of two features of one surface at rest; of two facets, the least of their vertices, edges and facets: 0 where they
/// cross.
double distance_at_rest(const SurfaceTreeState& s, const FeaturePair& pair);

}  // namespace morula::detail
