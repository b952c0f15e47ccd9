// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/boxes/lazy_boxes.hpp"

#include <algorithm>
#include <array>

#include "collide/pairs/descent.hpp"
#include "parallel/float_environment.hpp"
#include "surface/boxes/vertex_reader.hpp"

namespace morula::detail {

void LazyBoxes::start(const SurfaceTreeState& s) {
  state_ = &s;
  if (boxes_.levels.empty() || boxes_.levels[0].size() != s.boxes.levels[0].size()) {
    boxes_.make_levels(s.block_count());
    groups_.assign(boxes_.levels.size(), {});
  }
  if (boxes_.vertices.size() < s.blocks.vertex_of_slot.size()) boxes_.vertices.resize(s.blocks.vertex_of_slot.size());
  for (std::size_t level = 0; level < groups_.size(); ++level) {
    for (const std::uint32_t g : groups_[level]) boxes_.levels[level][g].clear();
    groups_[level].clear();
  }
  needs_block_.assign(s.block_count(), 0);
  needs_leaf_.assign(s.blocks_of_leaves.begin.size(), 0);
}

void LazyBoxes::want_all() {
  std::fill(needs_block_.begin(), needs_block_.end(), std::uint8_t{1});
}

void LazyBoxes::want(std::uint32_t leaf) {
  if (needs_leaf_[leaf] != 0) return;
  needs_leaf_[leaf] = 1;
  for (const std::uint32_t block : state_->blocks_of_leaves[leaf]) needs_block_[block] = 1;
}

const SurfaceBoxes& LazyBoxes::make(Workers& workers, std::optional<double> extent) {
  const SurfaceTreeState& s = *state_;
  slots_.clear();
  has_slot_.assign(s.blocks.vertex_of_slot.size(), 0);
  const auto take = [&](std::uint32_t slot) {
    if (has_slot_[slot] != 0) return;
    has_slot_[slot] = 1;
    slots_.push_back(slot);
  };
  for (std::uint32_t block = 0; block < s.block_count(); ++block) {
    if (needs_block_[block] == 0) continue;
    // mutant follow-corners: `take` -> `if (s.blocks.corners[i] >= s.blocks.own_vertices[block]) take`
    for (std::uint32_t i = s.blocks.corners_begin[block]; i < s.blocks.corners_begin[block + 1]; ++i)
      take(s.blocks.corners[i]);
    const std::uint32_t group = block / 8;
    if (groups_[0].empty() || groups_[0].back() != group) groups_[0].push_back(group);
  }
  const MakeVertexBoxes make_boxes = make_vertex_boxes();
  with_reader(s.pose.from, s.mesh.rest, [&](const auto& read) {
    parallel_for(workers, slots_.size(), vertices_at_once, [&](std::size_t begin, std::size_t end) {
      const StandardFloats standard;
      // One more element: the kernel reads one number beyond the last.
      std::array<Vec3, vertices_together + 1> points;
      std::array<MinBox, vertices_together> made;
      for (; begin < end; begin += vertices_together) {
        const std::size_t count = std::min(vertices_together, end - begin);
        for (std::size_t i = 0; i < count; ++i) {
          const Vec3 p = read(s.blocks.vertex_of_slot[slots_[begin + i]]);
          // mutant follow-placed: `s.pose.followed->is_placed` -> `false`
          points[i] = (s.pose.followed->is_placed ? s.pose.followed->spheres.transform()(p) : p) - s.origin;
        }
        make_boxes(points.data(), points.data(), count, made.data());
        for (std::size_t i = 0; i < count; ++i) boxes_.vertices[slots_[begin + i]] = made[i];
      }
    });
  });
  parallel_for(workers, groups_[0].size(), groups_at_once, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t first = 8 * std::size_t{groups_[0][i]};
      for (std::size_t block = first; block < std::min<std::size_t>(s.block_count(), first + 8); ++block)
        if (needs_block_[block] != 0) boxes_.join_block(s, block);
    }
  });
  for (std::size_t level = 1; level < groups_.size(); ++level) {
    for (const std::uint32_t g : groups_[level - 1])
      if (groups_[level].empty() || groups_[level].back() != g / 8) groups_[level].push_back(g / 8);
    for (const std::uint32_t g : groups_[level]) boxes_.join_group(level, g);
  }
  boxes_.measure();
  if (extent) boxes_.extent = *extent;
  return boxes_;
}

void QueryBoxes::start(const SurfaceTreeState& a, const SurfaceTreeState& b, double reach, bool by_spheres,
                       Workers& workers) {
  const bool are_two = &a != &b;
  const std::optional<FollowedBody>&body_a = a.pose.followed, &body_b = b.pose.followed;
  if (body_a) lazy_a_.start(a);
  if (are_two && body_b) lazy_b_.start(b);
  // mutant follow-covers: `body_a->covers() && body_b->covers()` -> `true`
  const bool uses_spheres = by_spheres && are_two && body_a && body_b && body_a->covers() && body_b->covers();
  if (uses_spheres) {
    const double farthest_a = a.farthest_of_spheres(body_a->spheres),
                 farthest_b = b.farthest_of_spheres(body_b->spheres);
    // Distances of features are computed from coordinates; 2^-46 of these is more than their error.
    const double rounding = 0x1p-46 * (farthest_a + farthest_b);
    // mutant follow-reach: `reach` -> `0 * reach`
    const TreePair trees(body_a->spheres, body_b->spheres, reach + rounding, leaf_level);
    each_overlapping(trees, [&](std::uint32_t leaf_a, std::uint32_t leaf_b) {
      lazy_a_.want(leaf_a);
      // mutant follow-both: `lazy_b_.want` -> `if (leaf_b % 2 == 0) lazy_b_.want`
      lazy_b_.want(leaf_b);
    });
    a_ = &lazy_a_.make(workers, farthest_a);
    b_ = &lazy_b_.make(workers, farthest_b);
    return;
  }
  const auto all = [&](LazyBoxes& boxes, const SurfaceTreeState& surface) {
    if (!surface.pose.followed) return &surface.boxes;
    boxes.want_all();
    return &boxes.make(workers);
  };
  a_ = all(lazy_a_, a);
  b_ = are_two ? all(lazy_b_, b) : a_;
}

}  // namespace morula::detail
