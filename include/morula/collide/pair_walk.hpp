// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pair walk: a traversal of the pairs of nodes of two trees, from the roots down, for the caller's own queries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/collide/collider.hpp>
#include <optional>

namespace morula {

/// The next action of the walk after a visited pair of nodes.
enum class Step : std::uint8_t {
  open,  ///< visit the pairs below this pair
  skip,  ///< go on without the pairs below this pair
  stop,  ///< end the walk
};

struct PairWalkOptions {
  /// Level set of both trees whose nodes form the final pairs; no value: leaves form them.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< largest gap between the spheres of a visited pair, mesh units; finite, 0 or more
};

/// Visits each pair of nodes, one of a and one of b, whose spheres are no farther apart than the margin, if the same
/// holds for all pairs above it. The pairs below a pair are those of a child of one node and a child of the other; a
/// node that is final stays, and is paired with the children of the other.
///
/// visit(pair, is_final): called once for each such pair on the calling thread; returns a Step. is_final: the pair has
/// no pairs below it, and `open` and `skip` have the same effect. The order is depth-first from the pair of roots;
/// pairs below one pair are in the order of b's nodes, then of a's.
///
/// A test may count a pair slightly beyond the margin as near, and never misses a pair within it. The walk reads
/// spheres only, so colliders without facets also serve. Returns the number of pair tests. Throws std::invalid_argument
/// for a body that queries reject, a margin out of range, and a level that neither tree has. It also throws, after the
/// last visit, if a visit has moved a body and none has stopped the walk. Cost: about 0.5 ns per pair test with
/// AVX-512, besides the visits.
template <class Visit>
std::size_t walk_pairs(const Collider& a, const Collider& b, const PairWalkOptions& options, const Visit& visit);

namespace detail {

using PairVisitor = Step (*)(void* visit, NodePair pair, bool is_final);
std::size_t walk_pairs(const Collider& a, const Collider& b, const PairWalkOptions& options, PairVisitor visitor,
                       void* visit);

}  // namespace detail

template <class Visit>
std::size_t walk_pairs(const Collider& a, const Collider& b, const PairWalkOptions& options, const Visit& visit) {
  return detail::walk_pairs(
      a, b, options,
      [](void* known, NodePair pair, bool is_final) { return (*static_cast<const Visit*>(known))(pair, is_final); },
      const_cast<void*>(static_cast<const void*>(std::addressof(visit))));
}

}  // namespace morula
