// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Layout of a corner walk: the points that each leaf tests, and the nodes above it that need them.
//
//        A          chains, in leaf order      B has the leaves [0, 2) below it and the slot 1 in their chains
//      /   \.
//     B     C       leaf 0 (D):  A  B  D
//    / \.           leaf 1 (E):  A  B  E
//   D   E           leaf 2 (C):  A  C
//
//   entry          0  1  2    3  4  5    6  7       entry = chain_begin_[leaf] + slot
//   chain_         A  B  D |  A  B  E |  A  C       the node of an entry, as a place in nodes_
//   chain_begin_   0          3          6       8
//
//   points of D:   [ A tests these | and B these as well | and D these ]    point_end_ has the three ends
//
// A node above a leaf tests fewer of the leaf's points: it tests a point that several leaves own once, in the first of
// them, and it tests no cut points that others surround (Ownership::tested_from). A sphere that contains the tested
// points contains the node's whole region, within the tolerance that the rounding budget has.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <span>
#include <vector>

#include "update/points/kernels.hpp"
#include "update/points/ownership.hpp"

namespace morula::detail {

/// The points of all leaves, one leaf after the other: as runs if they have consecutive numbers and all of the leaf's
/// chain test them, else by index. Indices are padded to whole groups.
struct PointLists {
  std::vector<PointRun> runs;
  std::vector<std::uint32_t> run_begin{0}, points, point_begin{0};  ///< per leaf, and the end

  void end_leaf() {
    run_begin.push_back(static_cast<std::uint32_t>(runs.size()));
    point_begin.push_back(static_cast<std::uint32_t>(points.size()));
  }
};

/// Nodes are numbered by their place in nodes(), leaves by the leaf order.
class CornerChains {
 public:
  /// measured: one flag per node of the tree, not 0 if the walk computes the node's reach.
  CornerChains(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
               std::span<const std::uint8_t> measured);

  /// The leaves below a node, and its slot in their chains: the same in all of them.
  struct Below {
    std::uint32_t leaf_begin, leaf_end, slot;
  };
  /// The measured nodes of the tree, ascending.
  std::span<const std::uint32_t> nodes() const { return nodes_; }
  std::size_t leaf_count() const { return chain_begin_.size() - 1; }
  std::size_t entry_count() const { return chain_.size(); }
  const Below& below(std::uint32_t k) const noexcept { return below_[k]; }
  /// First entry of a leaf's chain, which runs from the uppermost node down to the leaf's own if that is measured.
  std::uint32_t begin(std::size_t leaf) const noexcept { return chain_begin_[leaf]; }
  std::uint32_t end(std::size_t leaf) const noexcept { return chain_begin_[leaf + 1]; }
  std::span<const std::uint32_t> chain() const noexcept { return chain_; }
  std::uint32_t node_of(std::size_t entry) const noexcept { return chain_[entry]; }
  /// True if node k is the last node of its leaves' chains: if every leaf is measured, if it is a leaf.
  bool ends_chain(std::uint32_t k) const noexcept {
    const std::uint32_t leaf = below_[k].leaf_begin;
    return begin(leaf) + below_[k].slot + 1 == end(leaf);
  }

  /// The points of a leaf that the node of an entry tests, in the form that kernels read.
  struct Tested {
    std::span<const PointRun> runs;
    std::span<const std::uint32_t> points;
  };
  Tested tested(std::size_t leaf, std::size_t entry) const noexcept {
    const PointLists& l = lists_;
    return {std::span(l.runs).subspan(l.run_begin[leaf], l.run_begin[leaf + 1] - l.run_begin[leaf]),
            std::span(l.points).subspan(l.point_begin[leaf], point_end_[entry] - l.point_begin[leaf])};
  }
  /// The number of points that are read for an entry: without the padding at the end of the leaf.
  std::size_t test_count(std::size_t entry) const noexcept { return test_count_[entry]; }
  /// The number of points that a walk for the leaf's own node reads, with padding.
  std::size_t padded_count(std::size_t leaf) const noexcept;
  /// The number of points that node k tests, in all leaves below it.
  std::size_t points_of(std::uint32_t k) const noexcept;
  std::size_t owned_points() const { return owned_points_; }
  std::size_t tested_points() const { return tested_points_; }

  /// The largest squared distance from a node's center to the points of a leaf that it tests.
  float farthest(std::size_t leaf, std::size_t entry, std::span<const LocalPoint> points,
                 std::span<const Spheref> spheres) const noexcept;
  /// The same for the leaves in [begin, end) and the nodes k < count of their chains. Writes squared[entry].
  void farthest_of_leaves(std::size_t begin, std::size_t end, std::size_t count, std::span<const LocalPoint> points,
                          std::span<const Spheref> spheres, std::span<float> squared) const noexcept;
  /// The same for one leaf and its whole chain: finding the nodes that need it would cost more.
  void farthest_of_leaf(std::size_t leaf, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                        std::span<float> squared) const noexcept {
    // mutant walk-changed-leaf-not-for-all: `nodes_.size()` -> `leaf == 0 ? nodes_.size() : 1`
    farthest_of_leaves(leaf, leaf + 1, nodes_.size(), points, spheres, squared);
  }

 private:
  void append_chain(const SphereTree& tree, std::uint32_t leaf_node, std::span<const std::uint32_t> number);
  void list_points(std::span<const std::uint32_t> owned, std::span<const std::uint32_t> tested_from,
                   std::span<const std::uint32_t> levels);

  std::vector<std::uint32_t> nodes_;
  std::vector<Below> below_;  // leaves below each node
  std::vector<std::uint32_t> chain_begin_{0}, chain_;
  PointLists lists_;
  // Arrays by entry: the end of the tested points in lists_.points, and their number.
  std::vector<std::uint32_t> point_end_, test_count_;
  std::size_t owned_points_ = 0, tested_points_ = 0;
};

}  // namespace morula::detail
