// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of surfaces, and which of them a query keeps.
#pragma once

#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/swept.hpp>
#include <vector>

#include "held_query.hpp"
#include "surfaces.hpp"

namespace morula::python {

struct ProximityPairs {
  std::vector<ProximityPair> pairs;
};

struct SweptPairs {
  std::vector<SweptPair> pairs;
};

inline constexpr const char* pair_filter_wanted = "None or a function of (kind, a, b)";

PairFilter filter_of(std::uint32_t rings, double rest_distance, bool same_component, const Callback& keeps);

/// Runs a query on two surfaces; on one with itself where the other is none, or the same.
template <class Query>
SurfaceQueryStatus run_on(Query& query, const HeldSurface& a, const HeldSurface* b, Workers& workers) {
  return b && b != &a ? query.run(a.tree, b->tree, workers) : query.run(a.tree, workers);
}

}  // namespace morula::python
