// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vertices near a place at rest, found through the leaves that own them.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <span>
#include <vector>

#include "update/points/local_points.hpp"
#include "update/points/ownership.hpp"

namespace morula::detail {

/// A set of points that gives them back in ascending order.
class PointSet {
 public:
  explicit PointSet(std::size_t point_count) : words_(point_count / 64 + 1) {}
  void add(std::uint32_t point) { words_[point / 64] |= std::uint64_t{1} << (point % 64); }
  /// Leaves the set empty.
  void take(std::vector<std::uint32_t>& points);

 private:
  std::vector<std::uint64_t> words_;
};

class NearbyPoints {
 public:
  /// Borrows all but the tree. Every vertex that a facet uses is owned by some leaf.
  NearbyPoints(const Mesh& rest, const SphereTree& tree, const LeafOrder& order, const Ownership& ownership);
  /// Adds the vertices whose distance to the centre is at most the radius. Cost: leaves, and what those near own.
  void add(const Sphere& around, PointSet& points) const;

 private:
  const Mesh* rest_;
  const Ownership* ownership_;
  std::vector<Sphere> leaf_vertices_;  // per leaf of the order: contains the vertices that it owns
};

}  // namespace morula::detail
