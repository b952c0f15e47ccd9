// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How far nodes must reach: every leaf walks its points once, for itself and for all nodes above it, whose regions are
// unions of leaves' regions.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <span>
#include <vector>

#include "update/kernels.hpp"
#include "update/ownership.hpp"

namespace morula {

class CornerWalk {
 public:
  /// measured: one flag per level of the tree, for those whose nodes are measured.
  CornerWalk(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
             std::span<const std::uint8_t> measured);

  /// Takes the largest squared distance from the centre of each node to a point that it owns.
  void measure(std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers) noexcept;

  /// The same after a change: of the leaves that are flagged, for all nodes, and of other leaves for nodes that are
  /// flagged. Leaves by their order, nodes by their number in nodes(). Returns how many points were tested, once for
  /// each centre.
  std::size_t measure_again(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                     std::span<const std::uint8_t> leaf_changed, std::span<const std::uint8_t> node_moved,
                     Workers& workers) noexcept;

  /// The nodes that are measured, ascending.
  std::span<const std::uint32_t> nodes() const { return nodes_; }
  std::size_t leaf_count() const { return chain_begin_.size() - 1; }
  /// Of nodes()[k], as measured last.
  float squared_reach(std::size_t k) const noexcept;
  /// The nodes that a leaf is walked for, by their number in nodes(), the root's side first.
  std::span<const std::uint32_t> chain(std::size_t leaf) const {
    return std::span(chain_).subspan(chain_begin_[leaf], chain_begin_[leaf + 1] - chain_begin_[leaf]);
  }

  std::size_t owned_points() const { return owned_points_; }
  std::size_t tested_points() const { return tested_points_; }

 private:
  // The leaves below a node, and its place in their chains: one of level l has the same slot in all of them.
  struct Below {
    std::uint32_t leaf_begin, leaf_end, slot;
  };
  void add_points(std::span<const std::uint32_t> owned);
  // For some entries of the chain of a leaf, given by their place in chain_.
  void walk(std::size_t leaf, std::span<const std::uint32_t> entries, std::span<const LocalPoint> points,
            std::span<const Spheref> spheres) noexcept;

  std::vector<std::uint32_t> nodes_;
  std::vector<Below> below_;
  // Leaf k: its points, in runs where they lie one after the other, else by index, padded to whole groups.
  std::vector<std::uint32_t> run_begin_, point_begin_, points_;
  std::vector<PointRun> runs_;
  std::vector<std::uint32_t> chain_begin_, chain_;
  std::vector<float> squared_;            // parallel to chain_: of the leaf's points
  std::vector<std::uint32_t> points_of_leaf_, leaf_tests_;  // owned; tested by the last measure_again
  std::size_t owned_points_ = 0, tested_points_ = 0;
};

}  // namespace morula
