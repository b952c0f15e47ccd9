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

#include "update/anchors.hpp"
#include "update/kernels.hpp"
#include "update/local_points.hpp"
#include "update/ownership.hpp"

namespace morula {

/// What a body is made from, while it is being made.
struct Binding {
  const Mesh& mesh;
  const SphereTree& tree;
  std::span<const Rule> rule_of_level;
  const TriangleBvh& bvh;
  const LocalPoints& local;  ///< at rest
  const Rounding& rest_rounding;
  std::span<const Spheref> rest_spheres;  ///< the tree's, about the rest origin
  Workers& workers;
};

/// One flag per leaf of the order: does the leaf or a node above it follow `exact`?
std::vector<std::uint8_t> leaves_below_exact(const SphereTree& tree, const LeafOrder& order,
                                             std::span<const Rule> rule_of_level);

class ExactRule {
 public:
  /// Ties the centre of every node on a level with this rule.
  ExactRule(const Binding& binding, const LeafOrder& order, const Ownership& ownership);

  /// Writes the spheres of its nodes. Every leaf walks its points once, for itself and for all nodes above it: their
  /// regions are unions of leaves' regions. Nodes and leaves are independent.
  void update(std::span<const LocalPoint> points, const Rounding& rounding, std::span<Spheref> spheres,
              Workers& workers) noexcept;

  const Anchors& anchors() const { return anchors_; }
  std::size_t owned_points() const { return owned_points_; }
  std::size_t tested_points() const { return tested_points_; }

 private:
  void add_points(std::span<const std::uint32_t> owned);
  void choose_core(std::size_t k, const Binding& binding, std::span<const std::uint32_t> owned);
  void move_centers(std::span<const LocalPoint> points, std::span<Spheref> spheres, Workers& workers) noexcept;
  void measure_leaves(std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers) noexcept;
  void set_radii(const Rounding& rounding, std::span<Spheref> spheres, Workers& workers) noexcept;

  struct Node {
    std::uint32_t node;
    std::uint32_t leaf_begin, leaf_end;  // the leaves below it
    std::uint32_t slot;                  // its place in their chains
  };
  std::vector<Node> nodes_;
  Anchors anchors_;  // one tie per node of nodes_
  // core_size points of each node, its outermost, and how far they are from its centre at rest.
  std::vector<std::uint32_t> core_;
  std::vector<float> core_radius_;
  // Leaf k: its points, in runs where they lie one after the other, else by index, padded to whole groups; and its
  // chain: the nodes above it and itself that follow the rule, the root's side first. A node of level l has the same
  // slot in every chain that it is part of.
  std::vector<std::uint32_t> run_begin_, point_begin_, points_;
  std::vector<PointRun> runs_;
  std::vector<std::uint32_t> chain_begin_, chain_;
  std::vector<float> squared_;  // parallel to chain_: largest squared distance of the leaf's points
  std::size_t owned_points_ = 0, tested_points_ = 0;
};

}  // namespace morula
