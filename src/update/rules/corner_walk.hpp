// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Computes how far nodes must reach. Every leaf walks its points once, for itself and for all nodes above it, because
// their regions are unions of leaves' regions. corner_chains.hpp draws the layout; incremental_walk.hpp measures only
// changes.
#pragma once

#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

#include "update/rules/corner_chains.hpp"

namespace morula::detail {

/// Squared distances of the last measurement.
struct SquaredReaches {
  std::vector<float>
      of_entry;  ///< largest squared distance from the node of an entry to the leaf's points that it tests
  std::vector<float>
      of_node;  ///< largest squared distance from node k to all points that it tests: the largest of its entries

  /// The largest of node k's entries.
  float farthest_entry(const CornerChains& chains, std::uint32_t k) const noexcept;
};

class CornerWalk {
 public:
  /// measured: one flag per node of the tree, not 0 if the walk computes the node's reach.
  CornerWalk(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
             std::span<const std::uint8_t> measured);

  /// Computes the largest squared distance from the center of each node to a point that it tests.
  void measure(std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers) noexcept {
    measure_first(nodes().size(), points, spheres, workers);
  }
  /// Measures nodes()[0, count), which are whole levels. Other reaches stay.
  void measure_first(std::size_t count, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                     Workers& workers) noexcept;
  /// Measures nodes()[k] alone.
  void measure_one(std::uint32_t k, std::span<const LocalPoint> points, std::span<const Spheref> spheres) noexcept;

  const CornerChains& chains() const { return chains_; }
  std::span<const std::uint32_t> nodes() const { return chains_.nodes(); }
  /// IncrementalWalk measures a part and writes its results here.
  SquaredReaches& reaches() { return reaches_; }
  /// The last measured reach of nodes()[k].
  float squared_reach(std::size_t k) const noexcept { return reaches_.of_node[k]; }
  std::span<const float> squared_reaches() const { return reaches_.of_node; }

  std::size_t points_of(std::uint32_t k) const noexcept { return chains_.points_of(k); }
  std::size_t owned_points() const { return chains_.owned_points(); }
  std::size_t tested_points() const { return chains_.tested_points(); }

 private:
  void gather(std::size_t count) noexcept;

  CornerChains chains_;
  SquaredReaches reaches_;
};

}  // namespace morula::detail
