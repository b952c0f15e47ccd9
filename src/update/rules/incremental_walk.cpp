// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/incremental_walk.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace morula::detail {
namespace {

constexpr std::size_t fewest_groups = 32;  // groups of a leaf that gains by skipping a part of them
constexpr float is_walked = -1;            // value in the place of a bound

// Factor and addend that keep a bound above the largest squared distance that a walk would find. Let e = 2^-24. A
// squared distance is (1 + e)^5 of the real one, and the bound is squared, (1 + e): 3 e of the bound. Its terms: a root
// of a squared distance in float 3.5 e, a way since less: each step is computed in double and narrowed, e, steps are
// added up upwards, and their sum is narrowed, e. Two sums e each, the product e. Together below 10 e. Allowed: 2^-20 =
// 16 e. Squares below 2^-126 may vanish, which shortens each root by less than 2^-62. Allowed: 2^-60.
// mutant walk-rounding: `1 + 0x1p-20f` -> `1`
// mutant walk-rounding-less: `20f` -> `23f`
// mutant walk-underflow: `0x1p-60f` -> `0`
constexpr float rounding = 1 + 0x1p-20f, underflow = 0x1p-60f;

// The next double above x >= 0, as nextafter computes it.
double next_above(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) + 1);
}

// Least largest squared distance, at the last walk, of a group that may hold the farthest point after the center has
// moved by `way`: `most` was the largest of all. Let e = 2^-24, d the distance to the group's farthest point, D that of
// all, w the way. Squared distances are (1 + e)^5 of the real ones, so 2.6 e of the distance each, and squares that
// vanish shorten it by u = 2^-62. The group can be skipped if (d + w) (1 + 2.6 e) + u <= (D - w) (1 - 2.6 e) - u, where
// d <= sqrt(group) (1 + 2.6 e) + u and D >= sqrt(most) (1 - 2.6 e) - u: if sqrt(group) is at most sqrt(most) (1
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

IncrementalWalk::IncrementalWalk(const CornerChains& chains)
    : path_(chains.nodes().size()),
      path_when_walked_(chains.entry_count()),
      searched_(chains.nodes().size()),
      bounds_(chains.leaf_count()) {
  std::size_t longest = 0;
  for (std::size_t leaf = 0; leaf < chains.leaf_count(); ++leaf) {
    longest = std::max<std::size_t>(longest, chains.end(leaf) - chains.begin(leaf));
    const std::size_t count = chains.padded_count(leaf) / points_per_group;
    groups_.begin.push_back(groups_.begin.back() + static_cast<std::uint32_t>(count < fewest_groups ? 0 : count));
  }
  squared_before_.resize(longest);
  groups_.known = Marks(chains.leaf_count());
  groups_.squared.resize(groups_.begin.back());
  if (!groups_.squared.empty()) groups_.center.resize(chains.leaf_count());
}

void IncrementalWalk::forget() noexcept {
  if (is_fresh_) return;
  std::fill(path_.begin(), path_.end(), 0.0);
  std::fill(path_when_walked_.begin(), path_when_walked_.end(), 0.0);
  // mutant walk-groups-through-whole-updates: `groups_.known.clear()` -> ``
  groups_.known.clear();
  is_fresh_ = true;
}

std::size_t IncrementalWalk::measure(const Frame& frame, const Marks& changed_leaves, std::span<const MovedNode> moved,
                                     Marks& dirty) noexcept {
  const CornerChains& chains = frame.chains;
  std::size_t tested = 0;
  is_fresh_ = false;
  searched_.clear();
  for (const auto& [k, moved_by] : moved) {
    // mutant walk-path-swallows-steps: `next_above ... (moved_by))` -> `path_[k] + static_cast<double>(moved_by)`
    path_[k] = next_above(path_[k] + static_cast<double>(moved_by));  // rounded up, so that every move makes it longer
    dirty.add(k);
    if (!chains.ends_chain(k)) searched_.add(k);
  }
  changed_leaves.each([&](std::uint32_t leaf) { tested += measure_changed(frame, leaf, dirty); });
  for (const MovedNode& node : moved) {
    if (!chains.ends_chain(node.k)) continue;
    const std::uint32_t leaf = chains.below(node.k).leaf_begin;
    if (!changed_leaves.has(leaf)) tested += measure_moved(frame, leaf);
    frame.reaches.of_node[node.k] = frame.reaches.of_entry[chains.end(leaf) - 1];
  }
  searched_.each([&](std::uint32_t k) { tested += search(frame, k); });
  return tested;
}

std::size_t IncrementalWalk::walk(const Frame& frame, std::size_t leaf, std::size_t entry) noexcept {
  frame.reaches.of_entry[entry] = frame.chains.farthest(leaf, entry, frame.points, frame.spheres);
  path_when_walked_[entry] = path_[frame.chains.node_of(entry)];
  return frame.chains.test_count(entry);
}

// The reach of a node whose center stays is the largest of its leaves' reaches. If this leaf attains that reach, the
// reach is this leaf's; if it had less at its last measure, the reach is still another's. Else the others have to be
// searched. The leaf's last measure may be out of date for the node, but then the leaf had less: a search left it out
// because its bound was below the reach, which has only grown since, or was searched for again. So at worst the others
// are searched for nothing. A node whose center has moved is searched anyway.
std::size_t IncrementalWalk::measure_changed(const Frame& frame, std::uint32_t leaf, Marks& dirty) noexcept {
  const CornerChains& chains = frame.chains;
  std::vector<float>& squared = frame.reaches.of_entry;
  std::size_t tested = 0;
  const std::uint32_t begin = chains.begin(leaf), end = chains.end(leaf);
  std::copy(squared.begin() + begin, squared.begin() + end, squared_before_.begin());
  chains.farthest_of_leaf(leaf, frame.points, frame.spheres, squared);
  // mutant walk-groups-of-changed-leaves: `groups_.known.remove(leaf)` -> ``
  groups_.known.remove(leaf);
  for (std::uint32_t entry = begin; entry < end; ++entry) {
    const std::uint32_t k = chains.node_of(entry);
    float& reach = frame.reaches.of_node[k];
    path_when_walked_[entry] = path_[k];
    // mutant walk-changed-leaf-untold: `, dirty.add(k)` -> ``
    tested += chains.test_count(entry), dirty.add(k);
    if (squared[entry] >= reach || chains.ends_chain(k)) reach = squared[entry];
    // mutant walk-farthest-not-missed: `squared_before_[entry - begin] >= reach` -> `false`
    else if (squared_before_[entry - begin] >= reach)
      searched_.add(k);
  }
  return tested;
}

// Measures a leaf's own node, whose center alone has moved. If a group's farthest point was nearer than that of all by
// more than twice the way, it is not the farthest: the one has come nearer by at most the way, the other gone as far.
std::size_t IncrementalWalk::measure_moved(const Frame& frame, std::uint32_t leaf) noexcept {
  const CornerChains& chains = frame.chains;
  const std::uint32_t entry = chains.end(leaf) - 1, k = chains.node_of(entry);
  const auto groups =
      std::span(groups_.squared).subspan(groups_.begin[leaf], groups_.begin[leaf + 1] - groups_.begin[leaf]);
  if (groups.empty()) return walk(frame, leaf, entry);
  const auto [runs, index] = chains.tested(leaf, entry);
  const Vec3f& center = frame.spheres[chains.nodes()[k]].center;
  float& reach = frame.reaches.of_entry[entry];
  path_when_walked_[entry] = path_[k];
  if (groups_.known.has(leaf)) {
    float most = 0;
    for (const float squared : groups) most = std::max(most, squared);
    const float least = least_that_may_be_farthest(most, distance(Vec3(center), Vec3(groups_.center[leaf])));
    std::size_t count = 0;
    for (const float squared : groups) count += squared >= least ? 1 : 0;
    if (2 * count <= groups.size()) {
      reach = kernels().farthest_of_some(frame.points.data(), runs, index, center, groups.data(), least);
      return std::min<std::size_t>(count * points_per_group, chains.test_count(entry));
    }
  }
  kernels().farthest_of_groups(frame.points.data(), runs, index, center, groups.data());
  reach = *std::max_element(groups.begin(), groups.end());
  groups_.known.add(leaf);
  groups_.center[leaf] = center;
  return chains.test_count(entry);
}

// Walks the leaves that may hold a node's farthest point: none reaches farther than when it was last walked, which was
// after its last change, plus the node's way since.
std::size_t IncrementalWalk::search(const Frame& frame, std::uint32_t k) noexcept {
  const CornerChains::Below& below = frame.chains.below(k);
  const std::vector<float>& squared = frame.reaches.of_entry;
  const auto entry = [&](std::uint32_t leaf) { return frame.chains.begin(leaf) + below.slot; };
  const auto bound = [&](std::uint32_t leaf) {
    const double way = path_[k] - path_when_walked_[entry(leaf)];
    return (std::sqrt(squared[entry(leaf)]) + static_cast<float>(way)) * rounding + underflow;
  };
  float farthest = 0;  // largest reach of leaves walked at the node's present place
  float highest = -1;  // highest of the bounds of the others
  std::uint32_t most_promising = below.leaf_end;
  for (std::uint32_t leaf = below.leaf_begin; leaf < below.leaf_end; ++leaf) {
    if (path_when_walked_[entry(leaf)] == path_[k]) {
      farthest = std::max(farthest, squared[entry(leaf)]);
      bounds_[leaf] = is_walked;
      continue;
    }
    const float b = bounds_[leaf] = bound(leaf);
    if (b > highest) highest = b, most_promising = leaf;
  }
  std::size_t tested = 0;
  if (most_promising != below.leaf_end && highest * highest >= farthest) {
    tested += walk(frame, most_promising, entry(most_promising));
    farthest = std::max(farthest, squared[entry(most_promising)]);
    bounds_[most_promising] = is_walked;
    for (std::uint32_t leaf = below.leaf_begin; leaf < below.leaf_end; ++leaf) {
      const float b = bounds_[leaf];
      if (b < 0 || b * b < farthest) continue;
      tested += walk(frame, leaf, entry(leaf));
      farthest = std::max(farthest, squared[entry(leaf)]);
    }
  }
  frame.reaches.of_node[k] = farthest;
  return tested;
}

}  // namespace morula::detail
