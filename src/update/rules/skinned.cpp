// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The rule `skinned`: spheres that are moved and resized by the weights that move the surface [jones2017], and that
// read no vertex. It is an approximation: nothing makes a sphere contain its region.
//
// Jones et al. fit the spheres to a few example poses in advance and blend those centers and radii. A skin has no
// examples, only transforms. With w_b the mean weight of bone b over the distinct corners that a node owns, and
// B = sum w_b T_b, the node takes
//   c' = B c,   r' = |B| r,   |B| the largest stretch of the linear part, at most 3 % more (largest_stretch).
// If all bones of a node move alike, the surface does the same. If they turn against each other, B shrinks as the skin
// itself does, and corners whose weights differ from the mean may be left outside.
#include <algorithm>

#include "parallel/interruption.hpp"
#include "update/points/rounding.hpp"
#include "update/rules/engine_table.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t nodes_per_chunk = 32;

struct Share {
  std::uint32_t bone;
  double weight;
};

// Sum of the weights of one node after the other.
class ShareSum {
 public:
  ShareSum(const Skin& skin, const Cover& cover)
      : skin_(skin),
        cover_(cover),
        sum_(skin.bone_count),
        seen_by_(cover.vertex_count + cover.cut_points.size(), no_node) {}

  // In the order of bones; they add up to 1.
  std::vector<Share> shares_of(std::uint32_t node) {
    std::fill(sum_.begin(), sum_.end(), 0.0);
    for (const std::uint32_t corner : cover_.region_corners(node)) {
      if (seen_by_[corner] == node) continue;
      seen_by_[corner] = node;
      if (corner < cover_.vertex_count) {
        add(corner, 1);
      } else {
        const CutPoint& cut = cover_.cut_points[corner - cover_.vertex_count];
        for (std::size_t k = 0; k < 3; ++k) add(cut.vertex[k], cut.weight[k]);
      }
    }
    double total = 0;
    for (const double weight : sum_) total += weight;
    std::vector<Share> shares;
    for (std::uint32_t bone = 0; bone < sum_.size(); ++bone)
      if (sum_[bone] != 0) shares.push_back({bone, sum_[bone] / total});
    return shares;
  }

 private:
  void add(std::uint32_t vertex, double weight) {
    for (std::uint32_t k = skin_.begin[vertex]; k < skin_.begin[vertex + 1]; ++k)
      sum_[skin_.bones[k]] += weight * skin_.weights[k];
  }

  const Skin& skin_;
  const Cover& cover_;
  std::vector<double> sum_;
  std::vector<std::uint32_t> seen_by_;  // per corner
};

class SkinnedRule final : public RuleEngine {
 public:
  explicit SkinnedRule(const Binding& binding) {
    ShareSum sum(binding.options.skin, binding.model.cover);
    for (std::uint32_t node = 0; node < binding.rules.of_node.size(); ++node) {
      if (binding.rules.of_node[node] != Rule::skinned) continue;
      const std::vector<Share> shares = sum.shares_of(node);
      const auto begin = static_cast<std::uint32_t>(shares_.size());
      shares_.insert(shares_.end(), shares.begin(), shares.end());
      nodes_.push_back({node, begin, static_cast<std::uint32_t>(shares_.size()), binding.model.tree.spheres[node]});
    }
  }
  std::unique_ptr<RuleEngine> clone() const override { return std::make_unique<SkinnedRule>(*this); }

  void update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
              Workers& workers) noexcept override {
    const Uninterrupted whole;
    parallel_for(workers, nodes_.size(), nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        if (nodes_[k].node < node_end) spheres[nodes_[k].node] = sphere_of(nodes_[k], frame);
    });
  }

 private:
  struct Node {
    std::uint32_t node;        // ascending
    std::uint32_t begin, end;  // range of its shares
    Sphere rest;               // sphere of the tree
  };

  // Differences from the identity are added up: without any, the sphere is that of rest, bit for bit.
  Spheref sphere_of(const Node& n, const RuleFrame& frame) const noexcept {
    std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
    const std::array<Vec3, 3> identity = columns;
    Vec3 place = n.rest.center;
    for (std::uint32_t k = n.begin; k < n.end; ++k) {
      const Share& share = shares_[k];
      const AffineTransform& t = frame.bones->transforms[share.bone];
      for (std::size_t i = 0; i < 3; ++i) columns[i] += share.weight * (t.columns[i] - identity[i]);
      place += share.weight * displacement(t, n.rest.center);
    }
    const Vec3 center = place - frame.origin;
    // Adding zero makes a negative zero positive, like the other rules.
    const Vec3f nearest = Vec3f(center) + Vec3f{};
    const double radius = largest_stretch(columns) * n.rest.radius + distance(Vec3(nearest), center);
    return {nearest, rounded_up(std::min(radius, static_cast<double>(largest_radius)))};
  }

  std::vector<Node> nodes_;
  std::vector<Share> shares_;
};

}  // namespace

std::unique_ptr<RuleEngine> bind_skinned(const Binding& binding) {
  auto engine = std::make_unique<SkinnedRule>(binding);
  const std::vector<AffineTransform> at_rest(binding.options.skin.bone_count);
  const BonePose pose = binding.posers.skin->pose(binding.options.skin, at_rest);
  engine->update({.origin = pose.origin, .bones = &pose}, binding.spheres.size(), binding.spheres, binding.workers);
  return engine;
}

}  // namespace morula::detail
