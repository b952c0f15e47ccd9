// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Leaf fits: in every frame the centers of leaves go on from where anchors and pulls have brought them to where their
// spheres stick out of the surface less. Cover does not depend on it: radii are measured afterwards, from wherever
// centers are, over all that each leaf owns. Core and near points only say where a center is good.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/parallel/workers.hpp>
#include <span>
#include <vector>

#include "simd/float4.hpp"
#include "update/points/kernels.hpp"
#include "update/points/outermost.hpp"

namespace morula::detail {

class LeafFits {
 public:
  /// nodes: the leaves, by their order. cores: core_size points of each, its outermost ones. points, spheres: at the
  /// pose that the tree was made for.
  LeafFits(std::span<const std::uint32_t> nodes, std::span<const std::uint32_t> cores,
           std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers);

  /// Moves the centers of leaves that cost more than where the tree was made: none there, nor after a rigid motion.
  /// Depends on the frame alone. No allocation.
  void move(std::span<const LocalPoint> points, std::span<Spheref> spheres, Workers& workers) const noexcept;

 private:
  // Where entry i of a leaf's `size` points is.
  static std::size_t place(std::size_t leaf, std::size_t i, std::size_t size) {
    return nodes_at_once * (leaf / nodes_at_once * size + i) + leaf % nodes_at_once;
  }

  std::vector<std::uint32_t> nodes_;
  std::vector<std::uint32_t> cores_, near_;  // of groups of nodes_at_once leaves, as Kernels::fit_many takes them
  std::vector<float> enough_;                // of leaves, and infinite for those that fill up the last group
};

}  // namespace morula::detail
