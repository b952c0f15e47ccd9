// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pairs of features of surfaces, and which of them a query keeps.
#pragma once

#include <algorithm>
#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/surface/feature_pairs.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/swept.hpp>
#include <span>
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

/// A copy of millions of pairs takes a while: Ctrl-C ends it.
template <class Pair>
std::vector<Pair> copy_of(std::span<const Pair> pairs) {
  return without_gil([&] {
    constexpr std::size_t at_once = 1u << 16;
    std::vector<Pair> copy;
    copy.reserve(pairs.size());
    SignalCheck check;
    for (std::size_t i = 0; i < pairs.size(); i += at_once) {
      const auto chunk = pairs.subspan(i, std::min(at_once, pairs.size() - i));
      copy.insert(copy.end(), chunk.begin(), chunk.end());
      check();
    }
    return copy;
  });
}

inline constexpr const char* pair_filter_wanted = "None or a function of (kind, a, b)";

PairFilter filter_of(std::uint32_t rings, double rest_distance, bool same_component, const Callback& accepts);

/// Warns, once per surface and with the GIL, that a query of it with itself finds pairs at distance 0 where vertices
/// are at one position. None if their distance at rest leaves them out. b: null or a for a query with itself.
void warn_of_duplicates(const HeldSurface& a, const HeldSurface* b, double rest_distance);

/// Runs a query on two surfaces; on one with itself where the other is none, or the same.
template <class Query>
SurfaceQueryStatus run_on(Query& query, const HeldSurface& a, const HeldSurface* b, Workers& workers) {
  return b && b != &a ? query.run(a.tree, b->tree, workers) : query.run(a.tree, workers);
}

}  // namespace morula::python
