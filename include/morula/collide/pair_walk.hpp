// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pair walk: traverses the tree of node pairs of two sphere states, for the caller's own queries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/collide/collider.hpp>
#include <optional>

namespace morula {

/// Action of a walk at a pair of nodes whose spheres are no farther apart than the margin.
enum class Step : std::uint8_t {
  open,  ///< visit the pairs below
  skip,  ///< skip all pairs below
  stop,  ///< end the walk
};

struct PairWalkOptions {
  /// Level set of both trees for the final pairs; no value: the leaves.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< largest gap of visited pairs, mesh units; finite, not negative
};

/// Visits the pairs of nodes whose spheres, and the spheres of all pairs above them, are no farther apart than the
/// margin: depth-first, by the nodes of b, then of a. A pair opens into all pairs of children; if one node is final, it
/// is paired with the children of the other.
///
/// visit(pair, is_final): called once for each such pair, the pair of roots first, and returns a Step. At a final pair
/// only stop has an effect. Tests err on the near side: no pair within the margin is missed, and a pair slightly beyond
/// it may be visited. The walk reads spheres alone, so any two colliders serve. Returns the number of pair tests.
/// Throws std::invalid_argument for a body that queries reject, a margin out of range, and a level that neither tree
/// has; and at its end if a visit has moved a body, unless that visit stopped the walk. Cost: half a nanosecond per
/// pair test, in blocks of children against children.
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
