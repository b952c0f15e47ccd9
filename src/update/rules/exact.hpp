// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `exact`: each node's radius is the largest distance from its centre to a point that it owns.
#pragma once

#include <morula/parallel/workers.hpp>
#include <morula/query/triangle_bvh.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <morula/update/rules.hpp>
#include <span>
#include <vector>

#include "update/points/block_lists.hpp"
#include "update/points/local_points.hpp"
#include "update/points/ownership.hpp"
#include "update/rules/anchors.hpp"
#include "update/rules/corner_walk.hpp"

namespace morula {

/// What a body is made from, while it is being made.
struct Binding {
  const Mesh& mesh;
  const SphereTree& tree;
  std::span<const Rule> rule_of_node;
  const TriangleBvh* bvh;    ///< of the mesh; none where no node follows a link
  const LocalPoints& local;  ///< at rest
  const Rounding& rest_rounding;
  std::span<const Spheref> rest_spheres;  ///< the tree's, about the rest origin
  Workers& workers;
};

class ExactRule {
 public:
  /// Ties the centre of every node with this rule.
  ExactRule(const Binding& binding, const LeafOrder& order, const Ownership& ownership);

  /// Writes the spheres of its nodes. Nodes and leaves are independent.
  void update(std::span<const LocalPoint> points, const Rounding& rounding, std::span<Spheref> spheres,
              Workers& workers) noexcept {
    update_first(walk_.nodes().size(), points, rounding, spheres, workers);
  }
  /// Of the first `count` nodes of the walk alone: whole levels. The others can follow one by one.
  void update_first(std::size_t count, std::span<const LocalPoint> points, const Rounding& rounding,
                    std::span<Spheref> spheres, Workers& workers) noexcept;
  /// One node of the walk, at the points and with the rounding of update_first.
  void update_one(std::size_t k, std::span<const LocalPoint> points, std::span<Spheref> spheres) noexcept;

  /// The same spheres, where every leaf follows the rule and only these blocks of vertices differ from the update
  /// before. Returns the points tested.
  std::size_t update_changed(std::span<const LocalPoint> points, std::span<const std::uint32_t> changed_blocks,
                             const Rounding& rounding, std::span<Spheref> spheres) noexcept;

  const Anchors& anchors() const { return anchors_; }
  const CornerWalk& walk() const { return walk_; }

 private:
  void choose_core(std::size_t k, const Binding& binding, std::span<const std::uint32_t> owned);
  void find_dependents(const Binding& binding, const Ownership& ownership);
  Vec3f center(std::size_t k, std::span<const LocalPoint> points) const noexcept;
  void set_radius(std::size_t k, const Rounding& rounding, std::span<Spheref> spheres) const noexcept;

  CornerWalk walk_;
  Anchors anchors_;  // one tie per node of the walk
  // core_size points of each node, its outermost, and how far they are from its centre at rest.
  std::vector<std::uint32_t> core_;
  std::vector<float> core_radius_;
  BlockLists leaves_of_block_;  // leaves that own a point of the block, or one that is cut from it
  BlockLists nodes_of_block_;   // nodes whose centres look at it
  std::vector<std::uint8_t> leaf_changed_;
  std::vector<float> moved_;
  Rounding rounding_;  // of the last update
};

}  // namespace morula
