// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `exact` where a part of the vertices has moved.
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

  /// What the rule has, and the present frame. Nodes are numbered as in the walk.
  struct Frame {
    CornerWalk& walk;  ///< its reaches are measured
    const Anchors& anchors;
    const PackedCores& cores;
    std::span<const LocalPoint> points;
    std::span<Spheref> spheres;  ///< centers are moved, radii not
  };
  /// Returns how many points were tested.
  std::size_t update(const Frame& frame, const Marks& changed_blocks) noexcept;
  /// The nodes whose radius may differ since.
  const Marks& dirty() const { return dirty_; }
  /// All nodes have been updated without this.
  void forget() noexcept { walk_.forget(); }

 private:
  void move_centers(const Frame& frame, std::span<const std::uint32_t> nodes) noexcept;

  IncrementalWalk walk_;
  BlockLists leaves_of_block_;  // leaves that own a point of the block, or one that is cut from it
  BlockLists nodes_of_block_;   // nodes whose anchors or cores have such a point
  // Of one update.
  Marks changed_leaves_, dependents_, dirty_;
  std::vector<IncrementalWalk::MovedNode> moved_;
};

}  // namespace morula::detail
