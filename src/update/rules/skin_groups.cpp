// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Groups of the rule `skinned`: nodes with one main bone and, nearly, the same other bones.
#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

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

void put(const Vec3& v, LaneVectors& to, std::size_t lane) {
  to.x[lane] = v.x, to.y[lane] = v.y, to.z[lane] = v.z;
}

// The entry of a bone in a list by bone; null if there is none.
template <class Entry>
const Entry* entry_of(std::uint32_t bone, const std::vector<Entry>& by_bone) {
  const auto found = std::lower_bound(by_bone.begin(), by_bone.end(), bone,
                                      [](const Entry& entry, std::uint32_t b) { return entry.bone < b; });
  return found != by_bone.end() && found->bone == bone ? &*found : nullptr;
}

void put_node(const NodeBlend& blend, NodeGroup& group, std::size_t lane) {
  put(blend.node.rest.center, group.center, lane);
  group.radius[lane] = blend.node.rest.radius;
  for (const BlendTerm& term : blend.terms) group.weight_strays[lane] += term.weight_stray;
  put(blend.shape.center, group.shape_center, lane);
  for (std::size_t k = 0; k < 3; ++k) put(blend.shape.axes[k], group.shape_axes[k], lane);
  group.ball_radius[lane] = -1;
  if (const BoneBall* ball = entry_of(group.bone, blend.balls))
    put(ball->center, group.ball, lane), group.ball_radius[lane] = ball->radius;
}

void put_term(const NodeBlend& blend, GroupTerm& to, std::size_t lane) {
  to.ball_radius[lane] = -1;
  if (const BoneBall* ball = entry_of(to.bone, blend.balls))
    put(ball->center, to.ball, lane), to.ball_radius[lane] = ball->radius;
  const BlendTerm* term = entry_of(to.bone, blend.terms);
  if (term == nullptr) return;
  to.weight[lane] = term->weight, to.scale[lane] = term->scale;
  put(term->slope, to.slope, lane), put(term->moment, to.moment, lane);
  to.weight_stray[lane] = term->weight_stray, to.moment_stray[lane] = term->moment_stray;
}

}  // namespace

SkinBlend::SkinBlend(std::span<const NodeBlend> from) {
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
    for (std::size_t lane = 0; lane < lanes_of_group; ++lane) {
      const std::uint32_t member = members[lane < members.size() ? lane : 0];
      group.slot[lane] = member;
      put_node(from[member], group, lane);
      for (std::uint32_t i = group.first_term; i != group.end_term; ++i) put_term(from[member], terms[i], lane);
    }
    groups.push_back(group);
  }
}

}  // namespace morula::detail
