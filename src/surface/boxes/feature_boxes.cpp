// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/boxes/feature_boxes.hpp"

#include <algorithm>

namespace morula::detail {
namespace {

template <std::size_t N>
MinBox box_of_vertices(const SurfaceTreeState& s, const SurfaceBoxes& boxes,
                       const std::array<std::uint32_t, N>& vertices) {
  MinBox box;
  for (const std::uint32_t v : vertices) box.add(boxes.vertices[s.blocks.slot_of_vertex[v]]);
  return box;
}

}  // namespace

void FeatureBoxes::start(const SurfaceTreeState& state, const SurfaceBoxes& boxes, Features features) {
  state_ = &state;
  boxes_ = &boxes;
  frame_ = state.frame;
  features_ = features;
  used_ = 0;
  wanted_.clear();
  if (stamp_.size() < state.block_count()) {
    stamp_.resize(state.block_count(), now_);
    first_.resize(state.block_count());
  }
  if (++now_ == 0) {
    std::fill(stamp_.begin(), stamp_.end(), 0u);
    now_ = 1;
  }
}

void FeatureBoxes::want(std::uint32_t block) {
  if (stamp_[block] == now_) return;
  stamp_[block] = now_;
  first_[block] = static_cast<std::uint32_t>(used_);
  used_ += 1;
  if (features_ == Features::all) used_ += vertex_groups(block) + edge_groups(block);
  wanted_.push_back(block);
}

void FeatureBoxes::fill(Workers& workers) {
  if (groups_.size() < used_) groups_.resize(std::max(used_, groups_.size() + groups_.size() / 2));
  parallel_for(workers, wanted_.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) make(wanted_[i]);
  });
  wanted_.clear();
}

void FeatureBoxes::make(std::uint32_t block) {
  const SurfaceTreeState& s = *state_;
  BoxGroup* group = &groups_[first_[block]];
  group->clear();
  const std::size_t facets = std::min<std::size_t>(8, s.blocks.order.size() - 8 * std::size_t{block});
  for (std::size_t i = 0; i < facets; ++i)
    put(*group, i, box_of_vertices(s, *boxes_, s.blocks.facets_in_order[8 * std::size_t{block} + i]));
  if (features_ == Features::facets) return;
  const std::uint32_t vertex_begin = s.blocks.own_vertices[block], vertex_end = s.blocks.own_vertices[block + 1];
  for (std::uint32_t slot = vertex_begin; slot < vertex_end; ++slot) {
    const std::uint32_t place = (slot - vertex_begin) % 8;
    if (place == 0) (++group)->clear();
    put(*group, place, boxes_->vertices[slot]);
  }
  const std::uint32_t edge_begin = s.blocks.own_edges_begin[block], edge_end = s.blocks.own_edges_begin[block + 1];
  for (std::uint32_t i = edge_begin; i < edge_end; ++i) {
    const std::uint32_t place = (i - edge_begin) % 8;
    if (place == 0) (++group)->clear();
    put(*group, place, box_of_vertices(s, *boxes_, s.blocks.ends_of_own_edges[i]));
  }
}

}  // namespace morula::detail
