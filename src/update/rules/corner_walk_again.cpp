// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Updates of a part: which leaves are walked again, and for which nodes.
#include <algorithm>
#include <bit>
#include <cmath>

#include "update/rules/corner_walk.hpp"

namespace morula::detail {
namespace {

constexpr float unknown_no_more = -1;  // in place of a bound

// What keeps a bound above the largest squared distance that a walk would find. Let e = 2^-24. A squared distance is
// (1 + e)^5 of the real one, and the bound is squared, (1 + e): 3 e of the bound. Its terms: a root of a squared
// distance in float 3.5 e, a way since less: each step is taken in double and narrowed, e, steps are added up upwards,
// and their sum is narrowed, e. Two sums e each, the product e. Together below 10 e. Allowed: 2^-20 = 16 e. Squares
// below 2^-126 may vanish, which shortens each root by less than 2^-62. Allowed: 2^-60.
// mutant walk-rounding: `1 + 0x1p-20f` -> `1`
// mutant walk-rounding-less: `20f` -> `23f`
// mutant walk-underflow: `0x1p-60f` -> `0`
constexpr float rounding = 1 + 0x1p-20f, underflow = 0x1p-60f;

// Of x >= 0: what nextafter gives, upwards.
double next_above(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) + 1);
}

// What the largest squared distance of a group was at least, if the group may hold the farthest point now that the
// centre has moved: `most` was the largest of all. Let e = 2^-24, d the distance to the group's farthest point, D that
// of all, w the way. Squared distances are (1 + e)^5 of the real ones, so 2.6 e of the distance each, and squares that
// vanish shorten it by u = 2^-62. The group can be left out if (d + w) (1 + 2.6 e) + u <= (D - w) (1 - 2.6 e) - u,
// where d <= sqrt(group) (1 + 2.6 e) + u and D >= sqrt(most) (1 - 2.6 e) - u: if sqrt(group) is at most sqrt(most) (1
// - 10.5 e) - 2 w (1 + 5.3 e) - 4.1 u. Squaring that and narrowing it takes e and 2^-75 more.
float least_that_may_be_farthest(float most, double way) {
  // mutant walk-groups-rounding: `1 - 0x1p-20` -> `1`
  // mutant walk-groups-rounding-less: `- 0x1p-20` -> `- 0x1p-23`
  // mutant walk-groups-underflow: `0x1p-59` -> `0`
  constexpr double shorter = 1 - 0x1p-20, longer = 1 + 0x1p-20, vanishing = 0x1p-59;
  // mutant walk-groups-one-way: `2 * way` -> `way`
  const double least = std::sqrt(static_cast<double>(most)) * shorter - 2 * way * longer - vanishing;
  return least > 0 ? static_cast<float>(least * least) : 0.0f;
}

}  // namespace

std::size_t CornerWalk::measure_again(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                                      const Marks& changed_leaves, std::span<const MovedNode> moved,
                                      Marks& touched) noexcept {
  std::size_t tested = 0;
  paths_are_zero_ = false;
  searched_.clear();
  for (const auto& [k, way] : moved) {
    // mutant walk-path-swallows-steps: `next_above ... (way))` -> `path_[k] + static_cast<double>(way)`
    path_[k] = next_above(path_[k] + static_cast<double>(way));  // rounded up, so that every move makes it longer
    touched.add(k);
    if (!is_leaf(k)) searched_.add(k);
  }
  changed_leaves.each([&](std::uint32_t leaf) { tested += measure_changed(leaf, points, spheres, touched); });
  for (const MovedNode& node : moved) {
    if (!is_leaf(node.k)) continue;
    const std::uint32_t leaf = below_[node.k].leaf_begin, entry = chain_begin_[leaf] + below_[node.k].slot;
    if (!changed_leaves.has(leaf)) tested += walk_for_leaf(leaf, points, spheres);
    squared_reach_[node.k] = squared_[entry];
  }
  searched_.each([&](std::uint32_t k) { tested += search(k, points, spheres); });
  return tested;
}

// Of a node whose centre stays, the reach is the largest of what its leaves have. Where this leaf comes to have as
// much, the reach is this leaf's; where it had less before, the reach is still another's. Else the others have to be
// looked at. What was measured last of this leaf may be out of date for the node, but then the leaf had less: a search
// left it out because its bound was below the reach, which has only grown since, or was searched for again. So at worst
// the others are looked at for nothing. A node whose centre has moved is searched anyway.
std::size_t CornerWalk::measure_changed(std::uint32_t leaf, std::span<const LocalPoint> points,
                                        std::span<const Spheref> spheres, Marks& touched) noexcept {
  std::size_t tested = 0;
  const std::uint32_t begin = chain_begin_[leaf], end = chain_begin_[leaf + 1];
  std::copy(squared_.begin() + begin, squared_.begin() + end, squared_before_.begin());
  measure_leaf(leaf, points, spheres);
  // mutant walk-groups-of-changed-leaves: `groups_known_.remove(leaf)` -> ``
  groups_known_.remove(leaf);
  for (std::uint32_t entry = begin; entry < end; ++entry) {
    const std::uint32_t k = chain_[entry];
    // mutant walk-changed-leaf-untold: `, touched.add(k)` -> ``
    tested += looked_at_[entry], touched.add(k);
    if (squared_[entry] >= squared_reach_[k] || is_leaf(k)) squared_reach_[k] = squared_[entry];
    // mutant walk-farthest-not-missed: `squared_before_[entry - begin] >= squared_reach_[k]` -> `false`
    else if (squared_before_[entry - begin] >= squared_reach_[k])
      searched_.add(k);
  }
  return tested;
}

// For its own node, whose centre has moved by itself. Where a group has its farthest point farther than twice the way
// before that of all, that is not the farthest now: the one has come nearer by at most the way, the other gone as far.
std::size_t CornerWalk::walk_for_leaf(std::uint32_t leaf, std::span<const LocalPoint> points,
                                      std::span<const Spheref> spheres) noexcept {
  const std::uint32_t entry = chain_begin_[leaf + 1] - 1, k = chain_[entry];
  const auto runs = std::span(runs_).subspan(run_begin_[leaf], run_begin_[leaf + 1] - run_begin_[leaf]);
  const auto index = std::span(points_).subspan(point_begin_[leaf], point_end_[entry] - point_begin_[leaf]);
  const auto groups = std::span(groups_).subspan(group_begin_[leaf], group_begin_[leaf + 1] - group_begin_[leaf]);
  if (groups.empty()) return walk(leaf, entry, points, spheres);
  const Vec3f& center = spheres[nodes_[k]].center;
  path_then_[entry] = path_[k];
  if (groups_known_.has(leaf)) {
    float most = 0;
    for (const float squared : groups) most = std::max(most, squared);
    const float least = least_that_may_be_farthest(most, distance(Vec3(center), Vec3(group_center_[leaf])));
    std::size_t count = 0;
    for (const float squared : groups) count += squared >= least ? 1 : 0;
    if (2 * count <= groups.size()) {
      squared_[entry] = kernels().farthest_of_some(points.data(), runs, index, center, groups.data(), least);
      return std::min<std::size_t>(count * points_per_group, looked_at_[entry]);
    }
  }
  kernels().farthest_of_groups(points.data(), runs, index, center, groups.data());
  squared_[entry] = *std::max_element(groups.begin(), groups.end());
  groups_known_.add(leaf);
  group_center_[leaf] = center;
  return looked_at_[entry];
}

// Walks the leaves that may hold a node's farthest point: none reaches farther than when it was walked last, which was
// after its last change, plus the node's way since.
std::size_t CornerWalk::search(std::size_t k, std::span<const LocalPoint> points,
                               std::span<const Spheref> spheres) noexcept {
  const Below& below = below_[k];
  const auto entry = [&](std::uint32_t leaf) { return chain_begin_[leaf] + below.slot; };
  const auto is_known = [&](std::uint32_t leaf) { return path_then_[entry(leaf)] == path_[k]; };
  const auto bound = [&](std::uint32_t leaf) {
    const double way = path_[k] - path_then_[entry(leaf)];
    return (std::sqrt(squared_[entry(leaf)]) + static_cast<float>(way)) * rounding + underflow;
  };
  float farthest = 0;  // known
  float highest = -1;  // of the bounds of leaves not walked
  std::uint32_t most_promising = below.leaf_end;
  for (std::uint32_t leaf = below.leaf_begin; leaf < below.leaf_end; ++leaf) {
    if (is_known(leaf)) {
      farthest = std::max(farthest, squared_[entry(leaf)]);
      bounds_[leaf] = unknown_no_more;
      continue;
    }
    const float b = bounds_[leaf] = bound(leaf);
    if (b > highest) highest = b, most_promising = leaf;
  }
  std::size_t tested = 0;
  if (most_promising != below.leaf_end && highest * highest >= farthest) {
    tested += walk(most_promising, entry(most_promising), points, spheres);
    farthest = std::max(farthest, squared_[entry(most_promising)]);
    bounds_[most_promising] = unknown_no_more;
    for (std::uint32_t leaf = below.leaf_begin; leaf < below.leaf_end; ++leaf) {
      const float b = bounds_[leaf];
      if (b < 0 || b * b < farthest) continue;
      tested += walk(leaf, entry(leaf), points, spheres);
      farthest = std::max(farthest, squared_[entry(leaf)]);
    }
  }
  squared_reach_[k] = farthest;
  return tested;
}

}  // namespace morula::detail
