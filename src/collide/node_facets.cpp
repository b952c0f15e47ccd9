// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/node_facets.hpp"

#include <algorithm>

namespace morula {
namespace {

// Boxes are in float, yet need no pads: "minus the origin, rounded to double, rounded to float" keeps the order of
// coordinates, as equals at worst. Where intervals of doubles have a common number, so have these.
FloatBox box_of(const Triangle& t, const Vec3& origin) {
  FloatBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const double p = t[0][axis], q = t[1][axis], r = t[2][axis];
    const double lower = p < q ? p : q, upper = p < q ? q : p;
    box.bound[axis] = static_cast<float>((r < lower ? r : lower) - origin[axis]);
    box.bound[axis + 3] = static_cast<float>((r > upper ? r : upper) - origin[axis]);
  }
  return box;
}

}  // namespace

void NodeFacets::start(const Collider& collider, const Vec3& origin) {
  collider_ = &collider;
  origin_ = origin;
  used_ = facets_read_ = 0;
  const std::size_t nodes = collider.body().rest_tree().node_count();
  if (stamp_.size() < nodes) stamp_.resize(nodes, now_), range_.resize(nodes);
  if (++now_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0);
    now_ = 1;
  }
}

const NodeFacets::Range& NodeFacets::read(std::uint32_t node) {
  Range& range = range_[node];
  if (stamp_[node] == now_) return range;
  stamp_[node] = now_;
  const std::span<const std::uint32_t> facets = collider_->facets(node);
  range = {static_cast<std::uint32_t>(used_), static_cast<std::uint32_t>(facets.size()), {}};
  facets_read_ += facets.size();
  const std::size_t end = used_ + filled(facets.size());
  if (facet_.size() < end) {
    const std::size_t room = std::max(end, 2 * facet_.size());
    facet_.resize(room);
    triangle_.resize(room);
    for (std::vector<float>& bounds : bounds_) bounds.resize(room);
  }
  for (const std::uint32_t facet : facets) {
    const Triangle t = collider_->triangle(facet);
    const FloatBox box = box_of(t, origin_);
    range.box.add(box);
    facet_[used_] = facet;
    triangle_[used_] = t;
    for (std::size_t k = 0; k < 6; ++k) bounds_[k][used_] = box.bound[k];
    ++used_;
  }
  constexpr FloatBox empty;
  for (; used_ < end; ++used_)
    for (std::size_t k = 0; k < 6; ++k) bounds_[k][used_] = empty.bound[k];
  return range;
}

}  // namespace morula
