// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/leaf_surfaces.hpp"

#include <algorithm>

namespace morula {
namespace {

std::size_t filled(std::size_t count) {
  return (count + facet_columns_step - 1) / facet_columns_step * facet_columns_step;
}

/// A corner's barycentric coordinates in its facet, without those of the facet's first corner.
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

/// The share of its facet that a patch is: it stays the same under any deformation.
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

}  // namespace

void LeafSurfaces::take_shares() {
  const SphereTree& tree = collider_->body().rest_tree();
  const Cover& cover = collider_->body().cover();
  const std::uint32_t* const first = collider_->facets(0).data();
  share_.assign(collider_->facets(0).size(), 0);
  for (std::uint32_t leaf = 0; leaf < tree.node_count(); ++leaf) {
    if (!tree.is_leaf(leaf)) continue;
    const std::span<const std::uint32_t> facets = collider_->facets(leaf);
    for (std::uint32_t patch = cover.region_begin[leaf]; patch < cover.region_end[leaf]; ++patch) {
      const std::uint32_t facet = cover.patch_facet[patch];
      const auto entry = std::lower_bound(facets.begin(), facets.end(), facet) - facets.begin();
      share_[static_cast<std::size_t>(facets.data() - first + entry)] +=
          static_cast<float>(share_of(collider_->mesh().facets[facet], cover, patch));
    }
  }
}

void LeafSurfaces::start(const Collider& collider) {
  collider_ = &collider;
  const std::size_t nodes = collider.body().rest_tree().node_count();
  if (ownership_ != collider.body().ownership() || share_.size() != collider.facets(0).size()) {
    take_shares();
    ownership_ = collider.body().ownership();
  }
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

const LeafSurfaces::Leaf& LeafSurfaces::read(std::uint32_t node) {
  Leaf& leaf = leaf_[node];
  if (stamp_[node] == now_) return leaf;
  stamp_[node] = now_;
  const std::span<const std::uint32_t> facets = collider_->facets(node);
  const float* const share = share_.data() + (facets.data() - collider_->facets(0).data());
  leaf = {};
  leaf.begin = static_cast<std::uint32_t>(used_);
  leaf.size = static_cast<std::uint32_t>(facets.size());
  leaf.center = collider_->body().sphere(node).center;
  const std::size_t end = used_ + filled(facets.size());
  if (facet_.size() < end) {
    const std::size_t room = std::max(end, 2 * facet_.size());
    for (std::vector<float>& column : columns_) column.resize(room);
    facet_.resize(room);
    irregular_.resize(room);
  }

  double shortest = 0x1p1000;  // edge, squared
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const Facet& f = collider_->mesh().facets[facets[i]];
    const Triangle t{collider_->position(f[0]), collider_->position(f[1]), collider_->position(f[2])};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f corner(t[k] - leaf.center);
      leaf.extent = std::max(leaf.extent, largest_component(corner));
      leaf.largest_coordinate = std::max(leaf.largest_coordinate, largest_component(t[k]));
      for (int axis = 0; axis < 3; ++axis) columns_[3 * k + static_cast<std::size_t>(axis)][used_] = corner[axis];
    }
    const Vec3 u = t[1] - t[0], v = t[2] - t[0], normal = cross(u, v);
    const double uu = squared_length(u), vv = squared_length(v), ww = squared_distance(t[1], t[2]);
    const double sine = squared_length(normal) / (uu * vv);
    irregular_[used_] = !(sine > 1e-5);
    leaf.all_regular = leaf.all_regular && sine > 1e-5;
    shortest = std::min({shortest, uu, vv, ww});
    const double half_share = 0.5 * static_cast<double>(share[i]);
    leaf.area_vector += normal * half_share;
    leaf.area += length(normal) * half_share;
    facet_[used_++] = facets[i];
  }
  // Seen from afar, facets that are much smaller than the leaf are like slivers.
  const double least_edge = 0x1p-12 * static_cast<double>(leaf.extent);
  if (!(shortest > least_edge * least_edge)) {
    leaf.all_regular = false;
    std::fill(irregular_.begin() + leaf.begin, irregular_.begin() + leaf.begin + leaf.size, 1);
  }
  for (; used_ < end; ++used_)
    for (std::vector<float>& column : columns_) column[used_] = column[leaf.begin + leaf.size - 1];
  return leaf;
}

}  // namespace morula
