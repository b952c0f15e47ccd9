// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/nearby_points.hpp"

#include <algorithm>

namespace morula::detail {

NearbyPoints::NearbyPoints(const Mesh& rest, const SphereTree& tree, const LeafOrder& order, const Ownership& ownership)
    : rest_(&rest), ownership_(&ownership) {
  for (std::size_t k = 0; k < order.leaves.size(); ++k) {
    const Vec3& center = tree.spheres[order.leaves[k]].center;
    double squared = -1;  // of a leaf without vertices
    for (const std::uint32_t p : ownership.of_leaf(k))
      if (p < ownership.vertices.size())
        squared = std::max(squared, squared_distance(rest.positions[ownership.vertices[p]], center));
    leaf_vertices_.push_back({center, squared < 0 ? -1 : rounded_up_radius(std::sqrt(squared), max_norm(center))});
  }
}

void NearbyPoints::add(const Sphere& around, Marks& points) const {
  for (std::size_t k = 0; k < leaf_vertices_.size(); ++k) {
    const Sphere& leaf = leaf_vertices_[k];
    if (leaf.radius < 0 || distance(leaf.center, around.center) > (leaf.radius + around.radius) * (1 + 1e-9)) continue;
    for (const std::uint32_t p : ownership_->of_leaf(k)) {
      if (p >= ownership_->vertices.size()) break;  // ascending: cut points follow
      if (distance(rest_->positions[ownership_->vertices[p]], around.center) <= around.radius) points.add(p);
    }
  }
}

}  // namespace morula::detail
