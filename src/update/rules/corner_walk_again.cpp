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
constexpr float rounding = 1 + 0x1p-20f, underflow = 0x1p-60f;

// Of x >= 0: what nextafter gives, upwards.
double next_above(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) + 1);
}

}  // namespace

std::size_t CornerWalk::measure_again(std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                                      const Marks& changed_leaves, std::span<const MovedNode> moved,
                                      Marks& touched) noexcept {
  std::size_t tested = 0;
  paths_are_zero_ = false;
  searched_.clear();
  for (const auto& [k, way] : moved) {
    path_[k] = next_above(path_[k] + static_cast<double>(way));  // rounded up, so that every move makes it longer
    touched.add(k);
    if (!is_leaf(k)) searched_.add(k);
  }
  changed_leaves.each([&](std::uint32_t leaf) { tested += measure_changed(leaf, points, spheres, touched); });
  for (const MovedNode& node : moved) {
    if (!is_leaf(node.k)) continue;
    const std::uint32_t leaf = below_[node.k].leaf_begin, entry = chain_begin_[leaf] + below_[node.k].slot;
    if (!changed_leaves.has(leaf)) tested += walk(leaf, entry, points, spheres);
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
  for (std::uint32_t entry = begin; entry < end; ++entry) {
    const std::uint32_t k = chain_[entry];
    tested += looked_at_[entry], touched.add(k);
    if (squared_[entry] >= squared_reach_[k] || is_leaf(k))
      squared_reach_[k] = squared_[entry];
    else if (squared_before_[entry - begin] >= squared_reach_[k])
      searched_.add(k);
  }
  return tested;
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
