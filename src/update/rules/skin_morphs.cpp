// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_morphs.hpp"

#include <algorithm>
#include <cmath>

#include "parallel/interruption.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_blend.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t morphed_nodes_per_chunk = 32;

// A share of a vertex that follows a bone, which is numbered among the node's bones.
struct VertexShare {
  std::uint32_t vertex, bone;
  double factor;
};

// The corners of a node, each as a sum of shares.
class CornerShares {
 public:
  CornerShares(const Skin& skin, const Cover& cover, std::span<const std::uint32_t> corners) {
    for (const std::uint32_t corner : corners) {
      if (corner < cover.vertex_count) {
        add(skin, corner, 1);
      } else {
        const CutPoint& cut = cover.cut_points[corner - cover.vertex_count];
        for (std::size_t i = 0; i < 3; ++i) add(skin, cut.vertex[i], cut.weight[i]);
      }
      end_.push_back(shares_.size());
    }
    bones_ = numbers_;
    std::sort(bones_.begin(), bones_.end());
    bones_.erase(std::unique(bones_.begin(), bones_.end()), bones_.end());
    for (VertexShare& p : shares_)
      p.bone = static_cast<std::uint32_t>(std::lower_bound(bones_.begin(), bones_.end(), p.bone) - bones_.begin());
  }

  std::size_t corner_count() const { return end_.size(); }
  std::span<const VertexShare> corner(std::size_t k) const {
    const std::size_t begin = k == 0 ? 0 : end_[k - 1];
    return std::span(shares_).subspan(begin, end_[k] - begin);
  }
  std::span<const VertexShare> all() const { return shares_; }
  std::span<const std::uint32_t> bones() const { return bones_; }

 private:
  void add(const Skin& skin, std::uint32_t vertex, double factor) {
    each_weight(skin, vertex, [&](std::uint32_t bone, double weight) {
      if (weight == 0) return;
      shares_.push_back({vertex, bone, factor * weight});
      numbers_.push_back(bone);
    });
  }

  std::vector<VertexShare> shares_;
  std::vector<std::size_t> end_;  // by corner
  std::vector<std::uint32_t> bones_, numbers_;
};

// Writes the shares: middles and half ranges of the weights of each bone.
void add_shares(const CornerShares& shares, NodeMorphs& node) {
  const std::size_t count = shares.bones().size();
  std::vector<double> least(count), most(count), sum(count), weights(count);
  for (std::size_t k = 0; k < shares.corner_count(); ++k) {
    std::fill(weights.begin(), weights.end(), 0.0);
    for (const VertexShare& p : shares.corner(k)) weights[p.bone] += p.factor;
    for (std::size_t b = 0; b < count; ++b) {
      sum[b] += weights[b];
      least[b] = k == 0 ? weights[b] : std::min(least[b], weights[b]);
      most[b] = k == 0 ? weights[b] : std::max(most[b], weights[b]);
    }
  }
  const auto main = static_cast<std::size_t>(std::max_element(sum.begin(), sum.end()) - sum.begin());
  node.bone = shares.bones()[main];
  for (std::size_t b = 0; b < count; ++b) {
    if (b == main) continue;
    const double middle = least[b] + (most[b] - least[b]) / 2;
    // mutant skin-morph-weight-stray: `std::max(most[b] - middle, middle - least[b])` -> `0`
    node.shares.push_back({shares.bones()[b], middle, std::max(most[b] - middle, middle - least[b])});
  }
}

// The largest sum over bones of |h_b - w_b shift| over the corners.
double stray_about(const Vec3& shift, const CornerShares& shares, std::span<const Vec3> mode) {
  struct OfBone {
    Vec3 displacement;
    double weight = 0;
  };
  std::vector<OfBone> bones(shares.bones().size());
  double farthest = 0, largest = max_norm(shift);
  std::size_t most_shares = 0;
  for (std::size_t k = 0; k < shares.corner_count(); ++k) {
    const std::span<const VertexShare> corner = shares.corner(k);
    for (const VertexShare& p : corner) bones[p.bone] = {};
    double absolute = 0;
    for (const VertexShare& p : corner) {
      bones[p.bone].displacement += p.factor * mode[p.vertex];
      bones[p.bone].weight += p.factor;
      absolute += std::abs(p.factor) * (max_norm(mode[p.vertex]) + max_norm(shift));
    }
    double stray = 0;
    for (const VertexShare& p : corner) {  // each bone once
      OfBone& b = bones[p.bone];
      stray += safe_length(b.displacement - b.weight * shift);
      b = {};
    }
    farthest = std::max(farthest, stray);
    largest = std::max(largest, absolute);
    most_shares = std::max(most_shares, corner.size());
  }
  // Products of displacements near the smallest double lose all their digits.
  // mutant skin-morph-tiny: `* 0x1p-1070` -> `* 0`
  return rounded_up_radius(farthest, largest) + static_cast<double>(most_shares) * 0x1p-1070;
}

}  // namespace

NodeMorphs morphs_of_node(const Skin& skin, const Modes& modes, const Cover& cover,
                          std::span<const std::uint32_t> corners) {
  NodeMorphs node;
  if (corners.empty()) return node;
  const CornerShares shares(skin, cover, corners);
  add_shares(shares, node);
  std::vector<Vec3> displacements(corners.size());
  for (std::size_t j = 0; j < modes.mode_count; ++j) {
    check_interrupt();
    const std::span<const Vec3> mode = modes.mode(j);
    const bool moves = std::any_of(shares.all().begin(), shares.all().end(),
                                   [&](const VertexShare& p) { return p.factor != 0 && mode[p.vertex] != Vec3{}; });
    if (!moves) continue;
    for (std::size_t k = 0; k < corners.size(); ++k) displacements[k] = corner_position(cover, corners[k], mode);
    const Vec3 shift = mode_row(displacements).shift;
    node.rows.push_back({static_cast<std::uint32_t>(j), shift, stray_about(shift, shares, mode)});
  }
  return node;
}

SkinMorphs::SkinMorphs(std::span<const NodeMorphs> nodes, std::size_t mode_count, std::size_t bone_count)
    : row_begin_(mode_count + 1), bones_(bone_count), shifts_(nodes.size()), strays_(nodes.size()) {
  for (const NodeMorphs& from : nodes) {
    Node node{from.bone, static_cast<std::uint32_t>(shares_.size()), 0};
    double sum = 0;
    for (const NodeMorphs::Share& share : from.shares) sum += std::abs(share.weight) + share.stray;
    factor_sum_ = std::max(factor_sum_, sum);
    most_terms_ = std::max(most_terms_, from.shares.size() + 1);
    shares_.insert(shares_.end(), from.shares.begin(), from.shares.end());
    node.end_share = static_cast<std::uint32_t>(shares_.size());
    nodes_.push_back(node);
    for (const NodeMorphs::Row& row : from.rows) ++row_begin_[row.mode + 1];
  }
  for (std::size_t j = 0; j < mode_count; ++j) row_begin_[j + 1] += row_begin_[j];
  rows_.resize(row_begin_.back());
  std::vector<std::size_t> next = row_begin_;
  for (std::uint32_t k = 0; k < nodes.size(); ++k)
    for (const NodeMorphs::Row& row : nodes[k].rows) rows_[next[row.mode]++] = {k, row.shift, row.stray};
}

double SkinMorphs::reach() const {
  double largest = 0;
  for (const Row& row : rows_) largest = std::max({largest, max_norm(row.shift), row.stray});
  return largest;
}

void SkinMorphs::begin(const BonePose& pose, Workers& workers) noexcept {
  is_moved_ = !pose.morphs.empty();
  if (!is_moved_) return;
  for (std::size_t b = 0; b < bones_.size(); ++b) {
    const std::array<Vec3, 3>& columns = pose.transforms[b].columns;
    bones_[b] = {{columns[0] - Vec3{1, 0, 0}, columns[1] - Vec3{0, 1, 0}, columns[2] - Vec3{0, 0, 1}},
                 largest_stretch(columns)};
  }
  parallel_for(workers, nodes_.size(), morphed_nodes_per_chunk,
               [&](std::size_t begin, std::size_t end) { sum_rows(pose.morphs, begin, end); });
}

void SkinMorphs::sum_rows(std::span<const double> morphs, std::size_t begin, std::size_t end) noexcept {
  std::fill(shifts_.begin() + static_cast<std::ptrdiff_t>(begin), shifts_.begin() + static_cast<std::ptrdiff_t>(end),
            Vec3{});
  std::fill(strays_.begin() + static_cast<std::ptrdiff_t>(begin), strays_.begin() + static_cast<std::ptrdiff_t>(end),
            0.0);
  for (std::size_t j = 0; j < morphs.size(); ++j) {
    if (morphs[j] == 0) continue;
    const auto of_mode = std::span(rows_).subspan(row_begin_[j], row_begin_[j + 1] - row_begin_[j]);
    auto row = std::lower_bound(of_mode.begin(), of_mode.end(), begin,
                                [](const Row& r, std::size_t node) { return r.node < node; });
    for (; row != of_mode.end() && row->node < end; ++row) {
      shifts_[row->node] += morphs[j] * row->shift;
      // mutant skin-morph-sign: `std::abs(morphs[j])` -> `morphs[j]`
      // mutant skin-morph-stray: `std::abs(morphs[j]) * row->stray` -> `0`
      strays_[row->node] += std::abs(morphs[j]) * row->stray;
    }
  }
}

void SkinMorphs::add_to(std::size_t node, Sphere& sphere) const noexcept {
  if (!is_moved_) return;
  const Node& n = nodes_[node];
  const Vec3& shift = shifts_[node];
  const Bone& main = bones_[n.bone];
  const Vec3 of_main = times(main.columns, shift);
  double stretch = main.stretch;
  sphere.center += shift + of_main;
  for (std::uint32_t i = n.first_share; i < n.end_share; ++i) {
    const NodeMorphs::Share& share = shares_[i];
    const Bone& bone = bones_[share.bone];
    const Vec3 move = times(bone.columns, shift) - of_main;
    sphere.center += share.weight * move;
    // mutant skin-morph-blend: `share.stray * length(move)` -> `0`
    sphere.radius += share.stray * length(move);
    // mutant skin-morph-stretch: `std::max(stretch, bone.stretch)` -> `stretch`
    stretch = std::max(stretch, bone.stretch);
  }
  // mutant skin-morph-no-stretch: `stretch * strays_[node]` -> `strays_[node]`
  sphere.radius += stretch * strays_[node];
}

}  // namespace morula::detail
