// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Vertices near a place at rest, found through the leaves that own them.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <span>
#include <vector>

#include "update/points/local_points.hpp"
#include "update/points/marks.hpp"
#include "update/points/ownership.hpp"

namespace morula::detail {

class NearbyPoints {
 public:
  /// Borrows all but the tree. Every vertex that a facet uses is owned by some leaf.
  NearbyPoints(const Mesh& rest, const SphereTree& tree, const LeafOrder& order, const Ownership& ownership);
  /// Adds the vertices whose distance to the center is at most the radius. Cost: leaves, and what those near own.
  void add(const Sphere& around, Marks& points) const;

 private:
  const Mesh* rest_;
  const Ownership* ownership_;
  std::vector<Sphere> leaf_vertices_;  // per leaf of the order: contains the vertices that it owns
};

}  // namespace morula::detail
