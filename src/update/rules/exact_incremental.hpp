// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `exact` after a part of the vertices has moved.
//
//   changed blocks of vertices ──> leaves that own their points ────────────> changed_leaves_ ──┐
//                             └──> nodes whose centers depend on them ──> dependents_           ├─> walk ──> dirty_
//                                                                            └─ centers ─> moved_┘
#pragma once

#include <span>
#include <vector>

#include "update/points/block_lists.hpp"
#include "update/rules/anchors.hpp"
#include "update/rules/engine.hpp"
#include "update/rules/incremental_walk.hpp"
#include "update/rules/packed_cores.hpp"

namespace morula::detail {

class IncrementalExact {
 public:
  IncrementalExact(const Binding& binding, const CornerChains& chains, const Anchors& anchors,
                   const PackedCores& cores);

  /// Members of the rule, and the present frame. Nodes have the numbers of the walk.
  struct Frame {
    CornerWalk& walk;  ///< its reaches are measured
    const Anchors& anchors;
    const PackedCores& cores;
    std::span<const LocalPoint> points;
    std::span<Spheref> spheres;  ///< centers are moved, radii are not
  };
  /// Returns how many points were tested.
  std::size_t update(const Frame& frame, const Marks& changed_blocks) noexcept;
  /// The nodes whose radius may differ since the last update.
  const Marks& dirty() const { return dirty_; }
  /// Drops all incremental state after an update of all nodes without this.
  void forget() noexcept { walk_.forget(); }

 private:
  void move_centers(const Frame& frame, std::span<const std::uint32_t> nodes) noexcept;

  IncrementalWalk walk_;
  BlockLists leaves_of_block_;  // leaves that own a point of the block, or one that is cut from it
  BlockLists nodes_of_block_;   // nodes whose anchors or cores have such a point
  // Sets of one update.
  Marks changed_leaves_, dependents_, dirty_;
  std::vector<IncrementalWalk::MovedNode> moved_;
};

}  // namespace morula::detail
