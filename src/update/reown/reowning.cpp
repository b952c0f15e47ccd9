// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/reown/reowning.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace morula::detail {
namespace {

constexpr std::uint32_t none = 0xffffffffu;
// What an exchange has to bring, as a share of the donor's cost.
constexpr float least_gain = 1e-3f;
// A leaf that found no exchange is tried again after so many frames, twice as many each time: much the same would be
// found before.
constexpr std::uint64_t shortest_pause = 2, longest_pause = 16;
// Patches that one leaf gives away in one exchange, and how many more are tried after the best number so far.
constexpr std::size_t most_given = 24, patience = 3;

Vec3f at(const LocalPoint& p) {
  return {p.x, p.y, p.z};
}

// About the volume that a leaf's sphere holds outside the surface: what it owns, times how far the sphere sticks out of
// it, and less where it sticks out in one place alone. depth: from the centre to the nearest of what it owns.
float cost(float squared_reach, float depth, float area) {
  const float reach = std::sqrt(squared_reach), out = std::max(0.0f, reach - depth);
  return reach > 0 ? area * out * out / reach : 0.0f;
}

// SplitMix64's last step: dealings are told apart by it.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

Reowning::Reowning(std::shared_ptr<const CoveredTree> built, const LeafOrder& order, const Ownership& ownership,
                   std::span<const std::uint32_t> point_of_vertex, std::span<const LocalPoint> points,
                   std::span<const Spheref> spheres, std::span<const float> squared_reaches)
    : cover_(built->cover) {
  Fixed fixed{std::move(built), order.leaves, order.begin, order.end, {}, {}, {}, {}, {}};
  std::vector<std::uint32_t> point_of_cut(cover_.cut_points.size(), none);
  for (std::size_t k = 0; k < ownership.cut_points.size(); ++k)
    point_of_cut[ownership.cut_points[k]] = static_cast<std::uint32_t>(ownership.vertices.size() + k);
  for (const std::uint32_t c : cover_.corners)
    fixed.points.push_back(c < cover_.vertex_count ? point_of_vertex[c] : point_of_cut[c - cover_.vertex_count]);
  fixed.at_begin.assign(points.size() + 1, 0);
  for (const std::uint32_t p : fixed.points) ++fixed.at_begin[p + 1];
  for (std::size_t p = 0; p < points.size(); ++p) fixed.at_begin[p + 1] += fixed.at_begin[p];
  fixed.at.resize(fixed.points.size());
  std::vector<std::uint32_t> next = fixed.at_begin;
  for (std::uint32_t patch = 0; patch < cover_.patch_count(); ++patch) {
    const std::uint32_t begin = cover_.corner_begin[patch], end = cover_.corner_begin[patch + 1];
    Vec3f normal{};
    for (std::uint32_t i = begin; i < end; ++i) {
      fixed.at[next[fixed.points[i]]++] = patch;
      if (i < begin + 2) continue;
      const Vec3f from = at(points[fixed.points[begin]]);
      normal += cross(at(points[fixed.points[i - 1]]) - from, at(points[fixed.points[i]]) - from);
    }
    fixed.area.push_back(length(normal) / 2);
  }
  for (const std::uint32_t leaf : fixed.leaves) {
    float depth = std::sqrt(squared_reaches[leaf]);
    for (const std::uint32_t p :
         std::span(fixed.points)
             .subspan(cover_.corner_begin[cover_.region_begin[leaf]],
                      cover_.corner_begin[cover_.region_end[leaf]] - cover_.corner_begin[cover_.region_begin[leaf]]))
      depth = std::min(depth, distance(at(points[p]), spheres[leaf].center));
    fixed.depth.push_back(depth);
  }
  fixed_ = std::make_shared<const Fixed>(std::move(fixed));

  const std::size_t leaf_count = fixed_->leaves.size(), patches = cover_.patch_count();
  owner_.resize(patches), next_.resize(patches), before_.resize(patches);
  leaves_.resize(leaf_count);
  candidates_.reserve(leaf_count), changed_.reserve(leaf_count), seen_.reserve(leaf_count);
  recipients_.reserve(most_given), takers_.reserve(most_given);
  peeled_.reserve(patches), distinct_.reserve(fixed_->points.size());
  spare_facet_.reserve(patches), spare_begin_.reserve(patches), spare_corners_.reserve(cover_.corners.size());
  listed_.resize(points.size());
  start();
}

// Lists of patches as the tree has them.
void Reowning::start() {
  const Cover& home = fixed_->built->cover;
  for (std::uint32_t k = 0; k < leaves_.size(); ++k) {
    const std::uint32_t node = fixed_->leaves[k];
    const std::uint32_t begin = home.region_begin[node], end = home.region_end[node];
    Leaf& leaf = leaves_[k];
    leaf = {};
    leaf.depth = fixed_->depth[k];
    leaf.pause = shortest_pause;
    leaf.first = begin < end ? begin : none;
    leaf.count = end - begin;
    for (std::uint32_t p = begin; p < end; ++p) {
      owner_[p] = k;
      before_[p] = p == begin ? none : p - 1;
      next_[p] = p + 1 == end ? none : p + 1;
      leaf.area += fixed_->area[p];
    }
  }
  dealing_ = frame_ = 0;
}

void Reowning::give_back() noexcept {
  if (dealing_ != 0) {
    const Cover& home = fixed_->built->cover;
    std::copy(home.patch_facet.begin(), home.patch_facet.end(), cover_.patch_facet.begin());
    std::copy(home.corner_begin.begin(), home.corner_begin.end(), cover_.corner_begin.begin());
    std::copy(home.corners.begin(), home.corners.end(), cover_.corners.begin());
    std::copy(home.region_begin.begin(), home.region_begin.end(), cover_.region_begin.begin());
    std::copy(home.region_end.begin(), home.region_end.end(), cover_.region_end.begin());
  }
  start();
}

std::span<const std::uint32_t> Reowning::points_of_patch(std::uint32_t patch) const noexcept {
  const Cover& home = fixed_->built->cover;
  const std::uint32_t begin = home.corner_begin[patch];
  return std::span(fixed_->points).subspan(begin, home.corner_begin[patch + 1] - begin);
}

float Reowning::farthest(std::uint32_t patch, const Vec3f& center) noexcept {
  float squared = 0;
  for (const std::uint32_t p : points_of_patch(patch))
    squared = std::max(squared, squared_length(at(points_[p]) - center)), ++tests_;
  return squared;
}

float Reowning::nearest(std::uint32_t patch, const Vec3f& center) noexcept {
  float squared = std::numeric_limits<float>::infinity();
  for (const std::uint32_t p : points_of_patch(patch))
    squared = std::min(squared, squared_length(at(points_[p]) - center)), ++tests_;
  return std::sqrt(squared);
}

// Nodes above the taker that are not above the donor come to own the patch as well: they must reach it already.
bool Reowning::stays_inside(std::uint32_t patch, std::uint32_t from, std::uint32_t to, const Frame& frame) noexcept {
  const SphereTree& tree = fixed_->built->tree;
  for (std::uint32_t node = tree.parent[fixed_->leaves[to]]; node != no_node; node = tree.parent[node]) {
    if (fixed_->leaf_begin[node] <= from && from < fixed_->leaf_end[node]) return true;
    // mutant reown-ancestors-not-asked: `frame.squared_reaches` -> `4 * frame.squared_reaches`
    if (farthest(patch, frame.spheres[node].center) > frame.squared_reaches[node]) return false;
  }
  return true;
}

std::span<const std::uint32_t> Reowning::exchange(const Frame& frame, std::size_t most_tests) noexcept {
  points_ = frame.points;
  ++frame_;
  tests_ = 0;
  for (const std::uint32_t k : changed_) leaves_[k].changed = false;
  changed_.clear();
  candidates_.clear();
  for (std::uint32_t k = 0; k < leaves_.size(); ++k) {
    Leaf& leaf = leaves_[k];
    leaf.squared_reach = frame.squared_reaches[fixed_->leaves[k]];
    if (leaf.count < 2 || frame_ < leaf.retry) continue;
    candidates_.push_back({cost(leaf.squared_reach, leaf.depth, leaf.area), k});
  }
  std::make_heap(candidates_.begin(), candidates_.end());
  while (!candidates_.empty() && tests_ < most_tests) {
    std::pop_heap(candidates_.begin(), candidates_.end());
    const std::uint32_t leaf = candidates_.back().leaf;
    candidates_.pop_back();
    attempt(leaf, frame);
  }
  std::sort(changed_.begin(), changed_.end());
  // mutant reown-cover-kept: `if (!changed_.empty()) write_cover()` -> ``
  if (!changed_.empty()) write_cover();
  points_ = {};
  return changed_;
}

// The farthest patches, one more at a time, each to the neighbour that it costs least; as many as bring most.
void Reowning::attempt(std::uint32_t k, const Frame& frame) noexcept {
  Leaf& donor = leaves_[k];
  const Vec3f center = frame.spheres[fixed_->leaves[k]].center;
  peeled_.clear();
  float squared_depth = std::numeric_limits<float>::infinity();
  for (std::uint32_t patch = donor.first; patch != none; patch = next_[patch]) {
    float squared = 0;
    for (const std::uint32_t p : points_of_patch(patch)) {
      const float to_point = squared_length(at(points_[p]) - center);
      squared = std::max(squared, to_point), squared_depth = std::min(squared_depth, to_point);
    }
    tests_ += points_of_patch(patch).size();
    peeled_.push_back({squared, patch});
  }
  const float depth = donor.depth = std::sqrt(squared_depth);
  const float before = cost(donor.squared_reach, depth, donor.area);
  donor.pause = std::min(2 * donor.pause, longest_pause);
  donor.retry = frame_ + donor.pause;
  const std::size_t most = std::min(most_given, peeled_.size() - 1);
  std::partial_sort(peeled_.begin(), peeled_.begin() + static_cast<std::ptrdiff_t>(most + 1), peeled_.end());

  recipients_.clear(), takers_.clear();
  float added = 0, given = 0, best_gain = least_gain * before;
  std::size_t best = 0;
  for (std::size_t n = 0; n < most; ++n) {
    const std::uint32_t patch = peeled_[n].patch;
    const float area = fixed_->area[patch];
    float least = std::numeric_limits<float>::infinity();
    Recipient chosen{none, 0, 0};
    seen_.clear();
    const auto consider = [&](std::uint32_t leaf) {
      if (leaf == k || std::find(seen_.begin(), seen_.end(), leaf) != seen_.end()) return;
      seen_.push_back(leaf);
      Recipient now{leaf, leaves_[leaf].squared_reach, leaves_[leaf].area};
      for (const Recipient& r : recipients_)
        if (r.leaf == leaf) now = r;
      const float its_depth = leaves_[leaf].depth;
      const float squared = std::max(now.squared_reach, farthest(patch, frame.spheres[fixed_->leaves[leaf]].center));
      const float more = cost(squared, its_depth, now.area + area) - cost(now.squared_reach, its_depth, now.area);
      if (more < least && stays_inside(patch, k, leaf, frame)) least = more, chosen = {leaf, squared, now.area + area};
    };
    for (const std::uint32_t p : points_of_patch(patch))
      for (std::uint32_t i = fixed_->at_begin[p]; i < fixed_->at_begin[p + 1]; ++i) consider(owner_[fixed_->at[i]]);
    // What went before may have made other leaves neighbours.
    for (std::size_t i = 0; i < recipients_.size(); ++i) consider(recipients_[i].leaf);
    if (chosen.leaf == none) break;
    takers_.push_back(chosen.leaf);
    const auto known =
        std::find_if(recipients_.begin(), recipients_.end(), [&](const Recipient& r) { return r.leaf == chosen.leaf; });
    if (known != recipients_.end())
      *known = chosen;
    else
      recipients_.push_back(chosen);
    added += least, given += area;
    if (added > before || n >= best + patience) break;
    const float gain = before - cost(peeled_[n + 1].squared, depth, std::max(0.0f, donor.area - given)) - added;
    if (gain > best_gain) best_gain = gain, best = n + 1;
  }
  if (best == 0) return;
  for (std::size_t n = 0; n < best; ++n) {
    Leaf& taker = leaves_[takers_[n]];
    const Vec3f its_center = frame.spheres[fixed_->leaves[takers_[n]]].center;
    taker.squared_reach = std::max(taker.squared_reach, farthest(peeled_[n].patch, its_center));
    taker.depth = std::min(taker.depth, nearest(peeled_[n].patch, its_center));
    taker.retry = 0, taker.pause = shortest_pause;
    move(peeled_[n].patch, takers_[n]);
  }
  donor.squared_reach = peeled_[best].squared;
  donor.retry = 0, donor.pause = shortest_pause;
}

void Reowning::mark(std::uint32_t leaf) noexcept {
  if (std::exchange(leaves_[leaf].changed, true)) return;
  changed_.push_back(leaf);
}

void Reowning::move(std::uint32_t patch, std::uint32_t to) noexcept {
  Leaf &donor = leaves_[owner_[patch]], &taker = leaves_[to];
  mark(owner_[patch]), mark(to);
  (before_[patch] == none ? donor.first : next_[before_[patch]]) = next_[patch];
  if (next_[patch] != none) before_[next_[patch]] = before_[patch];
  before_[patch] = none, next_[patch] = taker.first;
  if (taker.first != none) before_[taker.first] = patch;
  taker.first = patch;
  owner_[patch] = to;
  --donor.count, ++taker.count;
  donor.area -= fixed_->area[patch], taker.area += fixed_->area[patch];
  dealing_ = mixed(dealing_ + 0x9e3779b97f4a7c15u + (std::uint64_t{patch} << 32 | to)) | 1;
}

// Regions are ranges in the order of the leaves, so what lies between the first leaf that changed and the last one is
// written anew, and moved within the arrays: whoever borrows the cover finds it where it was.
void Reowning::write_cover() noexcept {
  const Cover& home = fixed_->built->cover;
  const std::uint32_t first = changed_.front(), last = changed_.back();
  const std::uint32_t patch_begin = cover_.region_begin[fixed_->leaves[first]];
  const std::uint32_t corner_begin = cover_.corner_begin[patch_begin];
  spare_facet_.clear(), spare_begin_.clear(), spare_corners_.clear();
  for (std::uint32_t k = first; k <= last; ++k) {
    const std::uint32_t node = fixed_->leaves[k];
    const auto begin = patch_begin + static_cast<std::uint32_t>(spare_facet_.size());
    const auto append = [&](const Cover& from, std::uint32_t patch) {
      spare_begin_.push_back(corner_begin + static_cast<std::uint32_t>(spare_corners_.size()));
      spare_facet_.push_back(from.patch_facet[patch]);
      const auto corners = from.patch(patch);
      spare_corners_.insert(spare_corners_.end(), corners.begin(), corners.end());
    };
    if (leaves_[k].changed) {
      for (std::uint32_t p = leaves_[k].first; p != none; p = next_[p]) append(home, p);
    } else {
      const std::uint32_t from = cover_.region_begin[node], to = cover_.region_end[node];
      const std::uint32_t corner_from = cover_.corner_begin[from], corner_to = cover_.corner_begin[to];
      const std::uint32_t shift = corner_begin + static_cast<std::uint32_t>(spare_corners_.size()) - corner_from;
      spare_facet_.insert(spare_facet_.end(), cover_.patch_facet.begin() + from, cover_.patch_facet.begin() + to);
      for (std::uint32_t p = from; p < to; ++p) spare_begin_.push_back(cover_.corner_begin[p] + shift);
      spare_corners_.insert(spare_corners_.end(), cover_.corners.begin() + corner_from,
                            cover_.corners.begin() + corner_to);
    }
    cover_.region_begin[node] = begin;
    cover_.region_end[node] = patch_begin + static_cast<std::uint32_t>(spare_facet_.size());
  }
  std::copy(spare_facet_.begin(), spare_facet_.end(), cover_.patch_facet.begin() + patch_begin);
  std::copy(spare_begin_.begin(), spare_begin_.end(), cover_.corner_begin.begin() + patch_begin);
  std::copy(spare_corners_.begin(), spare_corners_.end(), cover_.corners.begin() + corner_begin);
  for (std::uint32_t node = 0; node < cover_.region_begin.size(); ++node) {
    cover_.region_begin[node] = cover_.region_begin[fixed_->leaves[fixed_->leaf_begin[node]]];
    cover_.region_end[node] = cover_.region_end[fixed_->leaves[fixed_->leaf_end[node] - 1]];
  }
}

std::span<const std::uint32_t> Reowning::points_of(std::size_t leaf) noexcept {
  distinct_.clear();
  // mutant reown-corner-of-another-leaf: `++listing_` -> `listing_`
  if (++listing_ == 0) std::fill(listed_.begin(), listed_.end(), 0u), listing_ = 1;
  for (std::uint32_t p = leaves_[leaf].first; p != none; p = next_[p]) {
    const auto points = points_of_patch(p);
    for (const std::uint32_t point : points)
      if (std::exchange(listed_[point], listing_) != listing_) distinct_.push_back(point);
  }
  return distinct_;
}

}  // namespace morula::detail
