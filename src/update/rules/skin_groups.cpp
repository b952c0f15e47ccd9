// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Groups of the rule `skinned`: nodes with one main bone and, nearly, the same other bones.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "geometry/rounded_up.hpp"
#include "update/rules/mode_rows.hpp"
#include "update/rules/skin_blend.hpp"

namespace morula::detail {
namespace {

using Bones = std::vector<std::uint32_t>;

// Nodes among which the next one of a group is looked for.
constexpr std::size_t window_size = 64;

Bones other_bones(const NodeBlend& blend) {
  Bones bones;
  for (const BlendTerm& term : blend.terms) bones.push_back(term.bone);
  return bones;
}

// Numbers of nodes, by main bone; those that it moves alone before the others, and alike bones near each other.
std::vector<std::uint32_t> by_bones(std::span<const NodeBlend> from, std::span<const Bones> bones) {
  std::vector<std::uint32_t> order(from.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return from[a].node.bone != from[b].node.bone ? from[a].node.bone < from[b].node.bone : bones[a] < bones[b];
  });
  return order;
}

// Takes nodes out of a window: the one with the most bones, then those that add the fewest to the group's.
class GroupChoice {
 public:
  explicit GroupChoice(std::span<const Bones> bones) : bones_(bones) {}

  std::vector<std::uint32_t> take(std::vector<std::uint32_t>& window) {
    std::vector<std::uint32_t> group;
    united_.clear();
    while (group.size() < lanes_of_group && !window.empty()) {
      const auto cost = [&](std::uint32_t node) {
        const std::size_t size = bones_[node].size();
        return group.empty() ? std::numeric_limits<std::size_t>::max() - size : added(bones_[node]);
      };
      auto best = window.begin();
      std::size_t least = cost(*best);
      for (auto it = best + 1; it != window.end(); ++it)
        if (const std::size_t c = cost(*it); c < least) least = c, best = it;
      Bones both;
      std::set_union(united_.begin(), united_.end(), bones_[*best].begin(), bones_[*best].end(),
                     std::back_inserter(both));
      united_ = std::move(both);
      group.push_back(*best);
      window.erase(best);
    }
    return group;
  }
  /// The other bones of the last group.
  const Bones& united() const { return united_; }

 private:
  std::size_t added(const Bones& bones) const {
    return static_cast<std::size_t>(std::count_if(bones.begin(), bones.end(), [&](std::uint32_t bone) {
      return !std::binary_search(united_.begin(), united_.end(), bone);
    }));
  }

  std::span<const Bones> bones_;
  Bones united_;
};

// The entry of a bone in a list by bone; null if there is none.
template <class Entry>
const Entry* entry_of(std::uint32_t bone, const std::vector<Entry>& by_bone) {
  const auto found = std::lower_bound(by_bone.begin(), by_bone.end(), bone,
                                      [](const Entry& entry, std::uint32_t b) { return entry.bone < b; });
  return found != by_bone.end() && found->bone == bone ? &*found : nullptr;
}

void put(const Vec3& v, LaneVectors& to, std::size_t lane) {
  to.x[lane] = static_cast<float>(v.x), to.y[lane] = static_cast<float>(v.y), to.z[lane] = static_cast<float>(v.z);
}

// Rest data of nodes in float, with allowances for the rounding of the kernels (skinned.cpp).
class LaneWriter {
 public:
  // terms: of the group.
  LaneWriter(const Vec3& pivot, double unit, std::size_t terms)
      : pivot_(pivot), unit_(unit), share_(0x1p-24 * (static_cast<double>(terms) + 16)) {}

  void put_node(const NodeBlend& blend, NodeGroup& group, std::size_t lane) const {
    const Vec3& center = blend.node.rest.center;
    group.center_x[lane] = center.x, group.center_y[lane] = center.y, group.center_z[lane] = center.z;
    put((center - pivot_) / unit_, group.place, lane);
    const double radius = blend.node.rest.radius / unit_, place = length((center - pivot_) / unit_);
    group.radius[lane] = above(radius);
    // mutant skinned-float-turn: `above(share_ * place)` -> `above(0 * place)`
    group.turn_stray[lane] = above(share_ * place);
    // mutant skinned-float-size: `above(share_ * 1.75 * radius)` -> `above(0 * radius)`
    group.size_stray[lane] = above(share_ * 1.75 * radius);
    put(blend.shape.center / unit_, group.shape_center, lane);
    double squares = squared_length(blend.shape.center / unit_);
    for (int column = 0, k = 0; column < 3; ++column) {
      const Vec3 axis = blend.shape.axes[static_cast<std::size_t>(column)] / unit_;
      for (int row = column; row < 3; ++row) group.shape_axes[k++][lane] = static_cast<float>(axis[row]);
      squares += squared_length(axis);
    }
    // mutant skinned-float-shape: `0x1p-20 * std::sqrt(squares)` -> `0 * std::sqrt(squares)`
    group.shape_stray[lane] = above(0x1p-20 * std::sqrt(squares));
    put_ball(blend, group.bone, group.ball, group.ball_radius, lane);
  }

  void put_term(const NodeBlend& blend, GroupTerm& to, std::size_t lane) const {
    put_ball(blend, to.bone, to.ball, to.ball_radius, lane);
    const BlendTerm* term = entry_of(to.bone, blend.terms);
    if (term == nullptr) return;
    const double radius = blend.node.rest.radius / unit_, place = length((blend.node.rest.center - pivot_) / unit_);
    const double weight = std::abs(term->weight), scale = std::abs(term->scale);
    const double slope = safe_length(term->slope * unit_), moment = length(term->moment / unit_);
    to.weight[lane] = static_cast<float>(term->weight), to.scale[lane] = static_cast<float>(term->scale);
    put(term->moment / unit_, to.moment, lane);
    double stray = term->weight_stray;
    // Slopes of nodes that are very small for the body could leave the range of float.
    if (slope <= 0x1p40)
      put(term->slope * unit_, to.slope, lane);
    else
      stray += slope * radius;
    const double moved = weight + slope * radius + stray;
    const double turned = moment + scale * radius + 2 * place * moved;
    // mutant skinned-float-moves: `stray + share_ * moved` -> `stray`
    to.weight_stray[lane] = above(stray + share_ * moved);
    // mutant skinned-float-turns: `share_ * turned` -> `0 * turned`
    to.moment_stray[lane] = above(term->moment_stray / unit_ + share_ * turned);
  }

 private:
  // A float that exceeds x by the share of the sums that follow.
  float above(double x) const { return x == 0 ? 0.0f : rounded_up(x * (1 + share_)); }

  void put_ball(const NodeBlend& blend, std::uint32_t bone, LaneVectors& centers, LaneFloats& radii,
                std::size_t lane) const {
    radii[lane] = -1;
    const BoneBall* ball = entry_of(bone, blend.balls);
    if (ball == nullptr) return;
    const Vec3 place = (blend.node.rest.center - pivot_ + ball->center) / unit_;
    put(place, centers, lane);
    // mutant skinned-float-ball: `0x1p-20 * length(place)` -> `0`
    radii[lane] = above(ball->radius / unit_ + 0x1p-20 * length(place));
  }

  Vec3 pivot_;
  double unit_, share_;
};

// A place amid the nodes.
Vec3 pivot_of(std::span<const NodeBlend> from) {
  std::vector<Vec3> centers;
  for (const NodeBlend& blend : from) centers.push_back(blend.node.rest.center);
  return centers.empty() ? Vec3{} : mode_row(centers).shift;
}

// The largest coordinate or radius of moments and balls. Those of a corner that cuts a facet can be far larger than the
// node: beyond the range of float, a comparison with NaN would leave a ball out of the hull.
double reach_of(const NodeBlend& blend) {
  double largest = 0;
  for (const BlendTerm& term : blend.terms) largest = std::max({largest, max_norm(term.moment), term.moment_stray});
  for (const BoneBall& ball : blend.balls) largest = std::max({largest, max_norm(ball.center), ball.radius});
  return largest;
}

// A power of two above all lengths at rest: places about the pivot, radii, moments and balls.
double unit_of(std::span<const NodeBlend> from, const Vec3& pivot, double least) {
  double largest = std::max(least, 0x1p-961);  // displacements in units are then below 2^1017
  for (const NodeBlend& blend : from) {
    const Sphere& rest = blend.node.rest;
    // mutant skinned-unit: `reach_of(blend)` -> `0 * reach_of(blend)`
    largest = std::max({largest, max_norm(rest.center - pivot), rest.radius, reach_of(blend)});
  }
  return std::ldexp(1, std::ilogb(largest) + 1);
}

}  // namespace

SkinBlend::SkinBlend(std::span<const NodeBlend> from, double least_unit)
    : pivot(pivot_of(from)), unit(unit_of(from, pivot, least_unit)) {
  std::vector<Bones> bones;
  for (const NodeBlend& blend : from) {
    nodes.push_back(blend.node);
    bones.push_back(other_bones(blend));
    factor_sum = std::max(factor_sum, blend.factor_sum);
    most_terms = std::max(most_terms, blend.terms.size());
  }
  std::map<BonePair, std::uint32_t> numbers;
  const auto number_of = [&](const BonePair& pair) {
    const auto [place, is_new] = numbers.emplace(pair, static_cast<std::uint32_t>(pairs.size()));
    if (is_new) pairs.push_back(pair);
    return place->second;
  };
  const std::vector<std::uint32_t> order = by_bones(from, bones);
  const auto is_alike = [&](std::uint32_t a, std::uint32_t b) {
    return from[a].node.bone == from[b].node.bone && bones[a].empty() == bones[b].empty();
  };
  GroupChoice choice(bones);
  std::vector<std::uint32_t> window;
  for (std::size_t next = 0; next < order.size() || !window.empty();) {
    while (next < order.size() && window.size() < window_size &&
           (window.empty() || is_alike(window.front(), order[next])))
      window.push_back(order[next++]);
    const std::vector<std::uint32_t> members = choice.take(window);
    NodeGroup group;
    group.bone = from[members.front()].node.bone;
    group.count = static_cast<std::uint32_t>(members.size());
    group.first_term = static_cast<std::uint32_t>(terms.size());
    for (const std::uint32_t bone : choice.united()) {
      GroupTerm& term = terms.emplace_back();
      term.bone = bone, term.pair = number_of({group.bone, bone});
    }
    group.end_term = static_cast<std::uint32_t>(terms.size());
    std::array<double, lanes_of_group> strays{};
    const LaneWriter writer(pivot, unit, choice.united().size());
    for (std::size_t lane = 0; lane < lanes_of_group; ++lane) {
      const std::uint32_t member = members[lane < members.size() ? lane : 0];
      group.slot[lane] = member;
      writer.put_node(from[member], group, lane);
      for (std::uint32_t i = group.first_term; i != group.end_term; ++i) {
        writer.put_term(from[member], terms[i], lane);
        strays[lane] += static_cast<double>(terms[i].weight_stray[lane]);
      }
      group.weight_strays[lane] = rounded_up(strays[lane] * (1 + 0x1p-40));
    }
    groups.push_back(group);
  }
}

}  // namespace morula::detail
