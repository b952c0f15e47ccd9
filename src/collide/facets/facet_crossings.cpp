// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/facets/facet_crossings.hpp"

#include "collide/facets/corner_reader.hpp"
#include "parallel/interruption.hpp"
#include "query/triangle_pairs.hpp"
#include "simd/float4.hpp"

namespace morula::detail {
namespace {

/// x and y in one register, z twice in another.
struct Registers {
  Double2 xy, z;
};
Registers registers(const Vec3& p) {
  return {Double2{p.x, p.y}, Double2(p.z)};
}

/// A transform by the operations of RigidTransform in their order, hence with the same bits, two coordinates at a time.
class Transform {
 public:
  explicit Transform(const RigidTransform& t)
      : columns_{registers({t.rows[0].x, t.rows[1].x, t.rows[2].x}), registers({t.rows[0].y, t.rows[1].y, t.rows[2].y}),
                 registers({t.rows[0].z, t.rows[1].z, t.rows[2].z})},
        translation_(registers(t.translation)) {}
  Registers operator()(const Vec3& p) const {
    const Double2 x = Double2(p.x), y = Double2(p.y), z = Double2(p.z);
    return {columns_[0].xy * x + columns_[1].xy * y + columns_[2].xy * z + translation_.xy,
            columns_[0].z * x + columns_[1].z * y + columns_[2].z * z + translation_.z};
  }

 private:
  Registers columns_[3], translation_;
};

}  // namespace

void NodeFacets::start(const Collider& collider, const Vec3& origin) {
  collider_ = &collider;
  origin_ = origin;
  used_ = facets_read_ = 0;
  triangles_.clear();
  const std::size_t nodes = collider.tree().node_count();
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
    triangle_of_.resize(room);
    for (std::vector<float>& bounds : bounds_) bounds.resize(room);
  }
  // Boxes are in float, yet need no pads: "minus the origin, rounded to double, rounded to float" keeps the order of
  // coordinates, at worst as equals. If two intervals of doubles have a common number, so have their images.
  const CornerReader corners(*collider_);
  const Transform transform(collider_->transform());
  const Registers origin = registers(origin_);
  for (const std::uint32_t facet : facets) {
    const Triangle t = corners(facet);
    const Registers p = transform(t[0]), q = transform(t[1]), r = transform(t[2]);
    const Double2 lower_xy = min(min(p.xy, q.xy), r.xy) - origin.xy;
    const Double2 upper_xy = max(max(p.xy, q.xy), r.xy) - origin.xy;
    const Double2 lower_z = min(min(p.z, q.z), r.z) - origin.z;
    const Double2 upper_z = max(max(p.z, q.z), r.z) - origin.z;
    const FloatBox box{{static_cast<float>(lower_xy[0]), static_cast<float>(lower_xy[1]),
                        static_cast<float>(lower_z[0]), static_cast<float>(upper_xy[0]),
                        static_cast<float>(upper_xy[1]), static_cast<float>(upper_z[0])}};
    range.box.add(box);
    facet_[used_] = facet;
    triangle_of_[used_] = unread;
    for (std::size_t k = 0; k < 6; ++k) bounds_[k][used_] = box.bound[k];
    ++used_;
  }
  constexpr FloatBox empty;
  for (; used_ < end; ++used_)
    for (std::size_t k = 0; k < 6; ++k) bounds_[k][used_] = empty.bound[k];
  return range;
}

void FacetCrossings::start(const Collider& a, const Collider& b) {
  const Vec3 origin = a.transform()(a.sphere_state().origin);
  facets_a_.start(a, origin);
  facets_b_.start(b, origin);
  tested_.clear();
  candidates_.clear();
  keys_.clear();
}

void FacetCrossings::collect_candidates(const NodePair& pair) {
  const NodeFacets::Range &range_a = facets_a_.read(pair.a), &range_b = facets_b_.read(pair.b);
  // The common box of both sides' facets shrinks as each side takes only its boxes that meet the other's.
  FloatBox common = range_a.box.meet(range_b.box);
  if (common.is_empty()) return;
  const BoxKernels& kernels = box_kernels();
  common = common.meet(kernels.box_of_meeting(facets_a_.boxes(range_a), common));
  if (common.is_empty()) return;
  common = common.meet(kernels.box_of_meeting(facets_b_.boxes(range_b), common));
  if (common.is_empty()) return;
  near_a_.select(facets_a_, range_a, common);
  near_b_.select(facets_b_, range_b, common);
  // Tests the shorter list against the longer one, so that registers are full.
  const bool few_a = near_a_.size() < near_b_.size();
  const Selection &few = few_a ? near_a_ : near_b_, &many = few_a ? near_b_ : near_a_;
  partners_.resize(std::max(partners_.size(), NodeFacets::filled(many.size())));
  for (std::size_t i = 0; i < few.size(); ++i) {
    const std::size_t count = kernels.select(many.boxes(), few.box(i), partners_.data());
    for (std::size_t j = 0; j < count; ++j) {
      const std::uint32_t slot_a = few_a ? few.slot(i) : many.slot(partners_[j]);
      const std::uint32_t slot_b = few_a ? many.slot(partners_[j]) : few.slot(i);
      const FacetPairKey key(facets_a_.facet(slot_a), facets_b_.facet(slot_b));
      if (tested_.insert(key.value)) candidates_.push_back({slot_a, slot_b, key});
    }
  }
}

bool FacetCrossings::add(const NodePair& nodes, Meter* meter) {
  check_interrupt();
  if (meter && meter->out_of_time()) return false;
  collect_candidates(nodes);
  if (meter && !meter->try_spend(static_cast<std::uint32_t>(candidates_.size()))) return false;
  find_meeting(
      candidates_.size(),
      [&](std::size_t i, const auto& put) {
        put(facets_a_.triangle(candidates_[i].slot_a), facets_b_.triangle(candidates_[i].slot_b));
      },
      [&](std::size_t i) { keys_.push_back(candidates_[i].key); });
  candidates_.clear();
  return true;
}

}  // namespace morula::detail
