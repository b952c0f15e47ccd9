// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/facets/leaf_surfaces.hpp"

#include <algorithm>
#include <cmath>

#include "collide/facets/corner_reader.hpp"
#include "simd/float4.hpp"

namespace morula::detail {
namespace {

std::size_t filled(std::size_t count) {
  return (count + facet_columns_step - 1) / facet_columns_step * facet_columns_step;
}

/// A corner's barycentric coordinates in its facet, without that of the facet's first corner.
std::array<double, 2> place_in(const Facet& facet, const Cover& cover, std::uint32_t corner) {
  std::array<double, 2> place{};
  const auto add = [&](std::uint32_t vertex, double weight) {
    if (vertex == facet[0]) return;
    if (vertex == facet[1])
      place[0] += weight;
    else if (vertex == facet[2])
      place[1] += weight;
  };
  if (corner < cover.vertex_count) {
    add(corner, 1);
  } else {
    const CutPoint& point = cover.cut_points[corner - cover.vertex_count];
    for (std::size_t k = 0; k < 3; ++k) add(point.vertex[k], point.weight[k]);
  }
  return place;
}

/// The area of a patch as a share of its facet; it is constant under any deformation.
double share_of(const Facet& facet, const Cover& cover, std::size_t patch) {
  const std::span<const std::uint32_t> corners = cover.patch(patch);
  double share = 0;
  std::array<double, 2> last = place_in(facet, cover, corners.back());
  for (const std::uint32_t corner : corners) {
    const std::array<double, 2> next = place_in(facet, cover, corner);
    share += last[0] * next[1] - last[1] * next[0];
    last = next;
  }
  return std::clamp(std::abs(share), 0.0, 1.0);
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

bool FacetShares::is_of(const Collider& collider) const {
  return cover_id_ == collider.sphere_state().cover_id && share_.size() == collider.facets(0).size();
}

void FacetShares::follow(const Collider& collider) {
  if (is_of(collider)) return;
  const SphereTree& tree = collider.tree();
  const Cover& cover = collider.cover();
  const std::uint32_t* const first = collider.facets(0).data();
  share_.assign(collider.facets(0).size(), 0);
  for (std::uint32_t leaf = 0; leaf < tree.node_count(); ++leaf) {
    if (!tree.is_leaf(leaf)) continue;
    const std::span<const std::uint32_t> facets = collider.facets(leaf);
    for (std::uint32_t patch = cover.region_begin[leaf]; patch < cover.region_end[leaf]; ++patch) {
      const std::uint32_t facet = cover.patch_facet[patch];
      const auto entry = std::lower_bound(facets.begin(), facets.end(), facet) - facets.begin();
      share_[static_cast<std::size_t>(facets.data() - first + entry)] +=
          static_cast<float>(share_of(collider.mesh_facets()[facet], cover, patch));
    }
  }
  cover_id_ = collider.sphere_state().cover_id;
}

void LeafSurfaces::start(const Collider& collider, const FacetShares& shares) {
  collider_ = &collider;
  share_ = shares.data();
  const std::size_t nodes = collider.tree().node_count();
  if (stamp_.size() < nodes) stamp_.resize(nodes, now_), leaf_.resize(nodes);
  if (++now_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0);
    now_ = 1;
  }
  used_ = 0;
}

FacetColumns LeafSurfaces::columns(const Leaf& leaf) const {
  FacetColumns list;
  for (std::size_t k = 0; k < 9; ++k) list.column[k] = columns_[k].data() + leaf.begin;
  list.count = filled(leaf.size);
  return list;
}

LeafSurfaces::Leaf& LeafSurfaces::read(std::uint32_t node) {
  Leaf& leaf = leaf_[node];
  if (stamp_[node] == now_) return leaf;
  stamp_[node] = now_;
  const std::span<const std::uint32_t> facets = collider_->facets(node);
  const float* const share = share_ + (facets.data() - collider_->facets(0).data());
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
    const double half_share = 0.5 * static_cast<double>(share[i]);
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
