// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A tree grown leaf by leaf, and pruned again.
#pragma once

#include "generators/driver/join.hpp"

namespace morula::detail {

/// A division worked out ahead, its children judged.
struct Prepared {
  Division division;
  std::vector<Verdict> verdicts;
};

struct Grown {
  BuildNode node;  // only leaves keep their region
  Verdict verdict;
  std::vector<std::uint32_t> children{};
  std::optional<Prepared> prepared{};
  bool dead_end = false;  // cannot be divided
};

/// Joins two sibling leaves after the other, those first that then take in least more, until at most `most` leaves are
/// left; a node whose children have become one is that leaf. nodes: the root first. Nodes that are joined away are no
/// longer among their parent's children.
void prune(std::vector<Grown>& nodes, std::size_t most, const LeafScore& score, const BuildRun& run, Workers& workers);

}  // namespace morula::detail
