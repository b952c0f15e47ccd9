// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nodes of the rule `skinned` that are measured on their own corners, like those of `exact`: only the vertices that
// their corners depend on are moved by the skin.
//
// The vertices move by the routine that moves the caller's positions, so the rounding of distances and of cut corners
// is that of `exact` (rounding.hpp). Its largest |coordinate| M is taken over the vertices of all facets of which a
// measured node owns a part: corners that are left out lie in the hull of others within a share of the edges of these
// facets. What `exact` does not have to pay for is the rounding of the skin's own sum, against the true product of
// transforms and weights. skinned.cpp bounds it, and the pad of a frame has it.
#pragma once

#include <morula/update/skin.hpp>
#include <span>
#include <vector>

#include "update/points/local_points.hpp"
#include "update/points/ownership.hpp"
#include "update/rules/engine.hpp"
#include "update/rules/exact.hpp"

namespace morula::detail {

class MeasuredNodes {
 public:
  /// ownership: points of all leaves, with tested_from, by hull_tolerance. measured: one flag per node of the tree.
  MeasuredNodes(const Binding& binding, const Ownership& ownership, std::span<const std::uint8_t> measured);

  /// Replaces the spheres of its nodes before node_end by measured ones that are smaller. spheres: those that follow
  /// from the bones; each covers its node, and so does the one that is kept. No allocation.
  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres, Workers& workers) noexcept;
  /// The same, but keeps the measured spheres even if they are larger. Returns false, and keeps all spheres, if a point
  /// is too far off for single precision.
  bool measure(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres, Workers& workers) noexcept;

  std::span<const std::uint32_t> nodes() const { return exact_.walk().nodes(); }
  /// Number of points that a node of nodes() tests.
  std::size_t points_of(std::uint32_t node) const { return exact_.points_of(node); }
  std::size_t tested_points() const { return exact_.tested_points(); }
  RuleEngine::MovedPoints moved_points() const { return {vertices_.size(), local_.cut_point_count()}; }

 private:
  MeasuredNodes(const Binding& binding, const Ownership& part, const TreeRules& rules);
  ExactRule tied(const Binding& binding, const Ownership& part, const TreeRules& rules);
  void pose(std::span<const AffineTransform> transforms, Workers& workers) noexcept;

  std::vector<std::uint32_t> vertices_;  // vertices of the mesh that move, ascending
  Skin skin_;                            // skin of these vertices
  std::vector<Vec3> rest_;               // rest positions of these vertices
  std::vector<Vec3> positions_;          // positions of the mesh; only these vertices move
  LocalPoints local_;
  ExactRule exact_;
  std::vector<Spheref> by_bones_;  // spheres of the nodes from the bones, in the current frame
};

}  // namespace morula::detail
