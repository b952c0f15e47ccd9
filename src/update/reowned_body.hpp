// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bodies whose patches may change hands, and whose leaves may be fitted (LeafFits): by the rule `exact`, made and
// updated here, and otherwise as any other.
#pragma once

#include <morula/update/body.hpp>

namespace morula::detail {

struct ReownedBody {
  struct Ways {
    bool reowns = false, fits_leaves = false;
  };
  /// Without either: a Body as any.
  static Body make(const Mesh& mesh, std::shared_ptr<const CoveredTree> built, Workers& workers, Ways ways);
  /// As Body::update, and then patches change hands until so many distances to corners were taken (Reowning::exchange).
  /// The spheres are those of who owns what afterwards.
  static UpdateStatus update(Body& body, const PositionView& positions, std::size_t most_tests,
                             Workers& workers) noexcept;
  /// Everyone owns what the tree says, from the next update on; nothing to do for other bodies. To be updated before
  /// anyone sees it.
  static void give_back(Body& body) noexcept;
};

}  // namespace morula::detail
