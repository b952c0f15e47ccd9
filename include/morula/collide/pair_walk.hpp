// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Pair walk: down the tree of node pairs of two sphere states. For queries of one's own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <morula/collide/collider.hpp>
#include <optional>

namespace morula {

/// What a walk does with a pair of nodes whose spheres are no farther apart than the margin.
enum class Step : std::uint8_t {
  open,  ///< look at the pairs below
  skip,  ///< leave it, and all below
  stop,  ///< end the walk
};

struct PairWalkOptions {
  /// Final pairs are of this level set of both trees; none: of the leaves.
  std::optional<std::uint32_t> level{};
  double margin = 0;  ///< mesh units, finite, not negative
};

/// Visits the pairs of nodes whose spheres are no farther apart than the margin, as are those of all pairs above them:
/// depth-first, by the nodes of b, then of a. A pair opens into all pairs of children, of the one node where the other
/// is final.
///
/// visit(pair, is_final): called once for each such pair, the pair of roots first. What it returns for a final pair
/// decides only between stop and going on. Tests err on the near side, so no pair that is near enough is left out; a
/// pair that is farther by rounding may be visited. Asks for spheres alone: any two colliders will do.
/// Returns the pair tests done. Throws std::invalid_argument for a body that may not be asked, a margin out of range,
/// and a level that neither tree has; at its end, where a visit that did not stop it has moved a body. Cost: half a
/// nanosecond per pair test, in blocks of children against children.
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
