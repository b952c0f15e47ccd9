// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Measures the reaches of a corner walk again after a part of the points and centers has moved, with the bits of a walk
// over all.
//
//   changed leaf    (a point has moved) is walked for its whole chain. If the leaf held the farthest point of a node
//                   above it and does so no more, that node is searched.
//   moved leaf      (only its center has moved) is walked for its own node. Groups of points that were nearer than the
//                   farthest one by more than twice the center's motion are skipped.
//   moved node      is searched: a leaf below is walked only if its bound reaches the node's largest distance so far.
//                   The bound is the distance when the leaf was walked last for the node, plus the path of the node's
//                   center since.
#pragma once

#include <span>
#include <vector>

#include "update/points/marks.hpp"
#include "update/rules/corner_walk.hpp"

namespace morula::detail {

class IncrementalWalk {
 public:
  /// Every leaf of the layout is measured.
  explicit IncrementalWalk(const CornerChains& chains);

  /// A node's place in CornerChains::nodes(), and how far its center has moved.
  struct MovedNode {
    std::uint32_t k;
    float moved_by;
  };
  /// Inputs of a measurement, and the place of its results.
  struct Frame {
    const CornerChains& chains;
    SquaredReaches& reaches;  ///< reaches of the last frame, which measure() updates
    std::span<const LocalPoint> points;
    std::span<const Spheref> spheres;
  };
  /// changed_leaves: leaves that own points which moved. moved: the nodes whose centers have moved, each once. Adds to
  /// dirty every node whose reach or center may have changed. Returns how many points were tested.
  std::size_t measure(const Frame& frame, const Marks& changed_leaves, std::span<const MovedNode> moved,
                      Marks& dirty) noexcept;
  /// Drops all paths and groups. Call it after a walk over all points.
  void forget() noexcept;

 private:
  std::size_t measure_changed(const Frame& frame, std::uint32_t leaf, Marks& dirty) noexcept;
  std::size_t measure_moved(const Frame& frame, std::uint32_t leaf) noexcept;
  std::size_t search(const Frame& frame, std::uint32_t k) noexcept;
  std::size_t walk(const Frame& frame, std::size_t leaf, std::size_t entry) noexcept;

  // The path of a node is the sum of its center's motions since forget(). By entry: the node's path when the leaf was
  // last walked for it. A leaf's own node is always measured.
  std::vector<double> path_, path_when_walked_;
  bool is_fresh_ = true;  // all paths are 0, no groups are known

  // Groups of leaves with many points that were walked for their own node alone and whose points have not moved since.
  struct PointGroups {
    Marks known;                          // leaves with groups
    std::vector<std::uint32_t> begin{0};  // first group per leaf, and the end; other leaves have no groups
    std::vector<float> squared;           // largest squared distance of each group to center
    std::vector<Vec3f> center;            // the leaf node's center when its groups were measured
  } groups_;

  // Scratch of one call.
  Marks searched_;                     // nodes whose leaves are to be searched
  std::vector<float> bounds_;          // bounds of leaves, in one search
  std::vector<float> squared_before_;  // entries of a chain before its leaf is measured again
};

}  // namespace morula::detail
