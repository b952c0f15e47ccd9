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

#include "update/points/kernels.hpp"
#include "update/points/marks.hpp"
#include "update/points/ownership.hpp"

namespace morula::detail {

class CornerWalk {
 public:
  /// measured: one flag per node of the tree.
  CornerWalk(const SphereTree& tree, const LeafOrder& order, const Ownership& ownership,
             std::span<const std::uint8_t> measured);

  /// Takes the largest squared distance from the centre of each node to a point that it owns.
  void measure(std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers) noexcept {
    measure_first(nodes_.size(), points, spheres, workers);
  }
  /// Of the first `count` of nodes() alone: whole levels.
  void measure_first(std::size_t count, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                     Workers& workers) noexcept;
  /// Of nodes()[k] alone.
  void measure_one(std::size_t k, std::span<const LocalPoint> points, std::span<const Spheref> spheres) noexcept;

  /// A place in nodes(), and how far its centre has moved.
  struct MovedNode {
    std::uint32_t k;
    float way;
  };
  /// The same after a change, where every leaf is measured. changed_leaves: leaves, by their order, that own points
  /// which moved. moved: each node once whose centre has moved. touched: gets those of nodes() whose reach or centre
  /// may differ. Leaves that cannot decide the reach of a node above are not walked for it. Returns how many points
  /// were tested.
  std::size_t measure_again(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                            const Marks& changed_leaves, std::span<const MovedNode> moved, Marks& touched) noexcept;

  /// The nodes that are measured, ascending.
  std::span<const std::uint32_t> nodes() const { return nodes_; }
  std::size_t leaf_count() const { return chain_begin_.size() - 1; }
  /// Of nodes()[k], as measured last.
  float squared_reach(std::size_t k) const noexcept { return squared_reach_[k]; }
  std::span<const float> squared_reaches() const { return squared_reach_; }

  /// Those that nodes()[k] looks at.
  std::size_t points_of(std::size_t k) const noexcept;
  std::size_t owned_points() const { return owned_points_; }
  std::size_t tested_points() const { return tested_points_; }

 private:
  // The leaves below a node, and its place in their chains: the same in all of them.
  struct Below {
    std::uint32_t leaf_begin, leaf_end, slot;
  };
  // For the entry at a place in chain_, which is of a leaf's chain. Returns how many points were tested.
  std::size_t walk(std::size_t leaf, std::size_t entry, std::span<const LocalPoint> points,
                   std::span<const Spheref> spheres) noexcept;
  void list_points(std::span<const std::uint32_t> owned, std::span<const std::uint32_t> tested_from,
                   std::span<const std::uint32_t> levels);
  LeafLists lists() const noexcept {
    return {runs_.data(),      run_begin_.data(), points_.data(),      point_begin_.data(),
            point_end_.data(), chain_.data(),     chain_begin_.data(), nodes_.data()};
  }
  float farthest(std::size_t k) const noexcept;
  // Does nodes()[k] end the chains of the leaves below it? Where every leaf is measured, it is a leaf then.
  bool is_leaf(std::uint32_t k) const noexcept {
    const std::uint32_t leaf = below_[k].leaf_begin;
    return chain_begin_[leaf] + below_[k].slot + 1 == chain_begin_[leaf + 1];
  }
  std::size_t walk_for_leaf(std::uint32_t leaf, std::span<const LocalPoint> points,
                            std::span<const Spheref> spheres) noexcept;
  std::size_t measure_changed(std::uint32_t leaf, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                              Marks& touched) noexcept;
  void measure_leaf(std::size_t leaf, std::span<const LocalPoint> points, std::span<const Spheref> spheres) noexcept;
  std::size_t search(std::size_t k, std::span<const LocalPoint> points, std::span<const Spheref> spheres) noexcept;

  std::vector<std::uint32_t> nodes_;
  std::vector<Below> below_;
  // Leaf k: its points, in runs where they lie one after the other and all of its chain looks at them, else by index;
  // first those that the uppermost looks at, and padded to whole groups.
  std::vector<std::uint32_t> run_begin_, point_begin_, points_;
  std::vector<PointRun> runs_;
  std::vector<std::uint32_t> chain_begin_, chain_;
  // Parallel to chain_: where that ends in points_ which the node looks at, and how many points it looks at.
  std::vector<std::uint32_t> point_end_, looked_at_;
  // How far the leaf's points, which have not moved since, reach from a node, parallel to chain_, as measured when the
  // node's path was path_then_. Of the leaf's own node always measured.
  std::vector<float> squared_;
  std::vector<double> path_then_;
  std::vector<float> squared_reach_;   // of each node
  std::vector<float> bounds_;          // of leaves, in one search
  std::vector<float> squared_before_;  // of a chain, while its leaf is measured again
  Marks searched_;                     // nodes whose leaves have to be looked at
  // Of leaves with many points that were walked for their own node alone and whose points have not moved since: the
  // largest squared distance from where the centre was then to a point of each group, in the order of runs and list.
  Marks groups_known_;
  std::vector<float> groups_;
  std::vector<std::uint32_t> group_begin_;
  std::vector<Vec3f> group_center_;
  std::vector<double> path_;     // of each node's centre, through all updates since all was measured
  bool paths_are_zero_ = false;  // path_ and path_then_
  std::size_t owned_points_ = 0, tested_points_ = 0;
};

}  // namespace morula::detail
