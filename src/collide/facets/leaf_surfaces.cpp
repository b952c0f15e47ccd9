// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/facets/leaf_surfaces.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "collide/facets/corner_reader.hpp"
#include "simd/float4.hpp"

namespace morula::detail {
namespace {

std::size_t filled(std::size_t count) {
  return (count + facet_columns_step - 1) / facet_columns_step * facet_columns_step;
}

/// The largest |coordinate| of all corners.
float largest(const FacetColumns& facets) {
  Float4 most{};
  for (const float* const column : facets.column)
    for (std::size_t i = 0; i < facets.count; i += 4) {
      const Float4 x = Float4::load(column + i);
      most = max(max(x, -x), most);
    }
  return largest_lane(most);
}

}  // namespace

void LeafSurfaces::start(const Collider& collider) {
  collider_ = &collider;
  if (++now_ == 0) {
    std::fill(table_.begin(), table_.end(), Entry{});
    now_ = 1;
  }
  leaf_count_ = 0;
  used_ = 0;
}

// An entry of an earlier batch counts as empty.
LeafSurfaces::Entry& LeafSurfaces::entry_of(std::uint32_t node) {
  const std::size_t mask = table_.size() - 1;
  std::size_t place = (std::size_t{node} * 0x9e3779b97f4a7c15u >> 32) & mask;
  while (table_[place].batch == now_ && table_[place].node != node) place = (place + 1) & mask;
  return table_[place];
}

void LeafSurfaces::grow() {
  const std::vector<Entry> before = std::exchange(table_, std::vector<Entry>(2 * table_.size()));
  for (const Entry& entry : before)
    if (entry.batch == now_) entry_of(entry.node) = entry;
}

FacetColumns LeafSurfaces::columns(const Leaf& leaf) const {
  FacetColumns list;
  for (std::size_t k = 0; k < 9; ++k) list.column[k] = columns_[k].data() + leaf.begin;
  list.count = filled(leaf.size);
  return list;
}

LeafSurfaces::Leaf& LeafSurfaces::read(std::uint32_t node) {
  if (const Entry& entry = entry_of(node); entry.batch == now_) return leaves_[entry.leaf];
  if (2 * (leaf_count_ + 1) > table_.size()) grow();
  if (leaf_count_ == leaves_.size()) leaves_.emplace_back();
  entry_of(node) = {node, now_, static_cast<std::uint32_t>(leaf_count_)};
  Leaf& leaf = leaves_[leaf_count_++];
  const std::span<const std::uint32_t> facets = collider_->facets(node);
  copy_shares(*collider_, node, share_);
  leaf = {};
  leaf.begin = static_cast<std::uint32_t>(used_);
  leaf.size = static_cast<std::uint32_t>(facets.size());
  leaf.center = collider_->sphere_state().sphere(node).center;
  const std::size_t end = used_ + filled(facets.size());
  if (facet_.size() < end) {
    const std::size_t room = std::max(end, 2 * facet_.size());
    for (std::vector<float>& column : columns_) column.resize(room);
    facet_.resize(room);
  }

  float* column[9];
  for (std::size_t k = 0; k < 9; ++k) column[k] = columns_[k].data() + used_;
  const CornerReader corners(*collider_);
  const Vec3 center = leaf.center;
  double area = 0;
  Vec3 area_vectors;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const Triangle t = corners(facets[i]);
    // Differences of corners about the center equal differences of the corners, up to about 2^-53 of a coordinate.
    const Vec3 p = t[0] - center, q = t[1] - center, r = t[2] - center;
    column[0][i] = static_cast<float>(p.x), column[1][i] = static_cast<float>(p.y),
    column[2][i] = static_cast<float>(p.z);
    column[3][i] = static_cast<float>(q.x), column[4][i] = static_cast<float>(q.y),
    column[5][i] = static_cast<float>(q.z);
    column[6][i] = static_cast<float>(r.x), column[7][i] = static_cast<float>(r.y),
    column[8][i] = static_cast<float>(r.z);
    const Vec3 normal = cross(q - p, r - p);
    const double half_share = 0.5 * static_cast<double>(share_[i]);
    area_vectors += normal * half_share;
    area += std::sqrt(squared_length(normal)) * half_share;
  }
  leaf.area_vector = area_vectors;
  leaf.area = area;
  std::copy(facets.begin(), facets.end(), facet_.begin() + leaf.begin);
  used_ += facets.size();
  for (; used_ < end; ++used_)
    for (std::vector<float>& filled_up : columns_) filled_up[used_] = filled_up[leaf.begin + leaf.size - 1];
  leaf.extent = largest(columns(leaf));
  return leaf;
}

}  // namespace morula::detail
