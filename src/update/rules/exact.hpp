// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `exact`: each node's radius is the largest distance from its center to a point that it owns.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <span>
#include <vector>

#include "simd/float4.hpp"
#include "update/points/kernels.hpp"
#include "update/points/outermost.hpp"
#include "update/rules/anchors.hpp"
#include "update/rules/corner_walk.hpp"
#include "update/rules/engine.hpp"
#include "update/rules/exact_incremental.hpp"
#include "update/rules/packed_cores.hpp"

namespace morula::detail {

/// Leaf fits: in every frame the centers of leaves move on from the places that anchors and pulls give them, to places
/// where their spheres stick out of the surface less. Cover does not depend on it: radii are measured afterwards, from
/// the final centers, over all points that each leaf owns. Core and near points only predict where a center is good.
class LeafFits {
 public:
  /// nodes: the leaves, by their order. cores: core_size points of each, its outermost ones. points, spheres: at the
  /// pose that the tree was made for.
  LeafFits(std::span<const std::uint32_t> nodes, std::span<const std::uint32_t> cores,
           std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers);

  /// Moves the centers of leaves that cost more than at the tree's own pose: none at that pose, nor after a rigid
  /// motion. Depends on the frame alone. No allocation.
  void move(std::span<const LocalPoint> points, std::span<Spheref> spheres, Workers& workers) const noexcept;

 private:
  // Index of entry i of a leaf's `size` points.
  static std::size_t place(std::size_t leaf, std::size_t i, std::size_t size) {
    return nodes_at_once * (leaf / nodes_at_once * size + i) + leaf % nodes_at_once;
  }

  std::vector<std::uint32_t> nodes_;
  std::vector<std::uint32_t> cores_,
      near_;                   // points of groups of nodes_at_once leaves, in the layout of Kernels::fit_many
  std::vector<float> enough_;  // costs of leaves that need no fit; infinite for the padding of the last group
};

class ExactRule final : public RuleEngine {
 public:
  /// Ties the center of every node with this rule.
  explicit ExactRule(const Binding& binding);
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<ExactRule>(*this); }

  /// Nodes and leaves are independent.
  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
              Workers& workers) noexcept override;
  std::size_t tested_points() const override { return walk_.tested_points(); }

  /// False if leaves are fitted, which is done for many of them at once.
  // mutant fit-not-when-lazy: `!fits_` -> `true`
  bool is_lazy() const override { return !fits_; }
  void update_one(std::uint32_t node, const RuleFrame& frame, std::span<Spheref> spheres) noexcept override;
  std::size_t tested_points(std::size_t node_end) const override;

  /// True if leaves are not fitted; every leaf follows the rule then.
  // mutant fit-not-of-parts: `!fits_` -> `true`
  bool follows_changes() const override { return !fits_; }
  std::size_t update_changed(const RuleFrame& frame, const Marks& changed_blocks,
                             std::span<Spheref> spheres) noexcept override;

  /// Makes every further update fit leaves (LeafFits). Every leaf has the rule. points, spheres: at the pose that the
  /// tree was made for.
  void fit_leaves(const LeafOrder& order, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                  Workers& workers);

  /// Number of points that a node of the tree tests.
  std::size_t points_of(std::uint32_t node) const { return walk_.points_of(place_of(node)); }
  const Anchors& anchors() const { return anchors_; }
  const CornerWalk& walk() const { return walk_; }

 private:
  void set_radii_of_all(std::span<Spheref> spheres) const noexcept;
  // Number of nodes of the walk that come before a node of the tree.
  std::uint32_t place_of(std::size_t node) const noexcept;
  Vec3f center(std::uint32_t k, std::span<const LocalPoint> points) const noexcept;
  // Moves the centers of nodes begin … end - 1 of the walk, a chunk of PackedCores or the beginning of one.
  void move_centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
                    std::span<Spheref> spheres) const noexcept;
  void set_radii(std::size_t begin, std::size_t end, std::span<Spheref> spheres) const noexcept;
  void set_radius(std::size_t k, const Rounding& rounding, std::span<Spheref> spheres) const noexcept;

  CornerWalk walk_;
  Anchors anchors_;  // ties, one per node of the walk
  std::optional<LeafFits> fits_{};
  PackedCores cores_;                              // core of each node of the walk
  std::optional<IncrementalExact> incremental_{};  // set once all nodes are tied
  Rounding rounding_;                              // rounding of the last update
};

}  // namespace morula::detail
