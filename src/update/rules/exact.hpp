// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `exact`: each node's radius is the largest distance from its centre to a point that it owns.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "update/points/block_lists.hpp"
#include "update/rules/anchors.hpp"
#include "update/rules/corner_walk.hpp"
#include "update/rules/engine.hpp"
#include "update/rules/leaf_fits.hpp"

namespace morula::detail {

class ExactRule final : public RuleEngine {
 public:
  /// Ties the centre of every node with this rule.
  explicit ExactRule(const Binding& binding);
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<ExactRule>(*this); }

  /// Nodes and leaves are independent.
  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
              Workers& workers) noexcept override;
  std::size_t tested_points() const override { return walk_.tested_points(); }

  /// Not where leaves are fitted, which is done for many of them at once.
  // mutant fit-not-when-lazy: `!fits_` -> `true`
  bool is_lazy() const override { return !fits_; }
  void update_one(std::uint32_t node, const RuleFrame& frame, std::span<Spheref> spheres) noexcept override;
  std::size_t tested_points(std::size_t node_end) const override;

  /// Where every leaf follows the rule.
  // mutant fit-not-of-parts: `!fits_` -> `true`
  bool follows_changes() const override { return !fits_; }
  std::size_t update_changed(const RuleFrame& frame, const Marks& changed_blocks,
                             std::span<Spheref> spheres) noexcept override;

  /// From now on leaves are fitted (LeafFits). Every leaf has the rule. points, spheres: at the pose that the tree was
  /// made for.
  void fit_leaves(const LeafOrder& order, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                  Workers& workers);

  const Anchors& anchors() const { return anchors_; }
  const CornerWalk& walk() const { return walk_; }

 private:
  void set_radii_of_all(std::span<Spheref> spheres) const noexcept;
  void pack_cores(const Binding& binding, std::span<const std::uint32_t> cores, std::span<const float> radii);
  // The core of node k of the walk: point i is first[nodes_at_once * i].
  struct Core {
    const std::uint32_t* first;
    std::size_t count;
  };
  Core core_of(std::size_t k) const noexcept {
    const std::uint32_t group = lane_[k] / nodes_at_once, begin = core_begin_[group], end = core_begin_[group + 1];
    return {&core_[begin + lane_[k] % nodes_at_once], (end - begin) / nodes_at_once};
  }
  void find_dependents(const Binding& binding);
  // How many nodes of the walk come before a node of the tree.
  std::size_t place_of(std::size_t node) const noexcept;
  Vec3f center(std::size_t k, std::span<const LocalPoint> points) const noexcept;
  // For nodes begin … end - 1 of the walk, where begin is a multiple of nodes_at_once.
  void move_centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
                    std::span<Spheref> spheres) const noexcept;
  void move_some(std::span<const std::uint32_t> nodes, std::span<const LocalPoint> points,
                 std::span<Spheref> spheres) noexcept;
  void set_radii(std::size_t begin, std::size_t end, std::span<Spheref> spheres) const noexcept;
  void set_radius(std::size_t k, const Rounding& rounding, std::span<Spheref> spheres) const noexcept;

  CornerWalk walk_;
  Anchors anchors_;  // one tie per node of the walk
  std::optional<LeafFits> fits_{};
  // Cores are the outermost points of nodes, once each, and the radius is how far they are from the centre at rest.
  // Nodes of a level and a chunk with about as many points are pulled together, one in each lane: groups of
  // nodes_at_once of them, whose points lie as Kernels::pull_many takes them. Short cores repeat their first point,
  // which changes no maximum; lanes beyond the last node are as that one's.
  std::vector<std::uint32_t> core_, core_begin_;
  std::vector<float> core_radius_;           // of lanes, of groups one after the other
  std::vector<std::uint32_t> node_of_lane_;  // nodes of the walk
  std::vector<std::uint32_t> lane_;          // of each node of the walk
  BlockLists leaves_of_block_;               // leaves that own a point of the block, or one that is cut from it
  BlockLists nodes_of_block_;                // nodes whose centres look at it
  // Of one update of a part.
  Marks changed_leaves_, hanging_, touched_;  // hanging_: nodes on what changed
  std::vector<CornerWalk::MovedNode> moved_;
  Rounding rounding_;  // of the last update
};

}  // namespace morula::detail
