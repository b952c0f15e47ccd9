// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/leaf_fits.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t leaves_per_chunk = 4 * nodes_at_once;
// Points that may come to be the nearest to a leaf's center, in radii.
constexpr float farthest_near = 2;
// A leaf that costs no more than this times what it cost where the tree was made is good: a rigid motion changes no
// cost by more than rounding does, and what a builder chose with care stays.
// mutant fit-kept-at-rest: `1.05f` -> `0.5f`
// mutant fit-of-rigid-motions: `1.05f` -> `1`
constexpr float most_costly = 1.05f;

Vec3f at(const LocalPoint& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

// The points nearest to a center on all sides of it are, turned inside out about it, the outermost: y = x / |x|² takes
// a sphere through the center to a plane, so the farthest y along a direction is the x that a sphere which grows from
// the center that way meets first.
LeafFits::LeafFits(std::span<const std::uint32_t> nodes, std::span<const std::uint32_t> cores,
                   std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers)
    : nodes_(nodes.begin(), nodes.end()) {
  const std::size_t leaf_count = nodes.size();
  const std::size_t padded = (leaf_count + nodes_at_once - 1) / nodes_at_once * nodes_at_once;
  cores_.resize(padded * core_size), near_.resize(padded * near_size);
  enough_.resize(padded, std::numeric_limits<float>::infinity());
  parallel_for(workers, leaf_count, leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<LocalPoint> inverted;
    std::vector<std::uint32_t> around, listed;
    std::array<std::uint32_t, near_size> near;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      const std::span<const std::uint32_t> core = cores.subspan(core_size * leaf, core_size);
      const Spheref& sphere = spheres[nodes[leaf]];
      inverted.clear(), around.clear(), listed.clear();
      for (std::uint32_t p = 0; p < points.size(); ++p) {
        const Vec3f out = at(points[p]) - sphere.center;
        const float squared = squared_length(out), limit = farthest_near * sphere.radius;
        if (!(squared > 0) || squared > limit * limit) continue;
        const Vec3f y = out * (1 / squared);
        listed.push_back(static_cast<std::uint32_t>(inverted.size()));
        inverted.push_back({y.x, y.y, y.z, 0});
        around.push_back(p);
      }
      if (around.empty()) {
        near.fill(core.front());
      } else {
        outermost(inverted, listed, {}, near);
        for (std::uint32_t& p : near) p = around[p];
      }
      float most = 0, nearest = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < core_size; ++i) {
        cores_[place(leaf, i, core_size)] = core[i];
        most = std::max(most, squared_length(at(points[core[i]]) - sphere.center));
      }
      for (std::size_t i = 0; i < near_size; ++i) {
        near_[place(leaf, i, near_size)] = near[i];
        nearest = std::min(nearest, squared_length(at(points[near[i]]) - sphere.center));
      }
      enough_[leaf] = std::max(0.0f, most_costly * (most - nearest));
    }
  });
}

void LeafFits::move(std::span<const LocalPoint> points, std::span<Spheref> spheres, Workers& workers) const noexcept {
  static_assert(leaves_per_chunk % nodes_at_once == 0);
  const Uninterrupted whole;
  parallel_for(workers, nodes_.size(), leaves_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::array<LocalPoint, nodes_at_once> centers;
    for (std::size_t first = begin; first < end; first += nodes_at_once) {
      const std::size_t count = std::min(nodes_at_once, end - first);
      for (std::size_t j = 0; j < nodes_at_once; ++j) {
        const Vec3f& center = spheres[nodes_[first + std::min(j, count - 1)]].center;
        centers[j] = {center.x, center.y, center.z, 0};
      }
      kernels().fit_many(points.data(), {&cores_[core_size * first], &near_[near_size * first], &enough_[first]},
                         centers.data());
      for (std::size_t j = 0; j < count; ++j) spheres[nodes_[first + j]].center = at(centers[j]);
    }
  });
}

}  // namespace morula::detail
