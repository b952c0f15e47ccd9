// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Reading a front: its cut, its finished pairs, and whether a front from outside is well formed.
#include <utility>

#include "collide/front/front_walk.hpp"

namespace morula::detail {
namespace {

bool holds(const NodeRange& range, std::uint32_t node) {
  return node >= range.first && node - range.first < range.count;
}

}  // namespace

// Calls f(pair, whether it overlaps) for all pairs that were tested: the roots, and all pairs below opened pairs.
template <class F>
void FrontWalk::each_verdict(const F& f) const {
  for (std::uint32_t i = 0; i < front.pairs.size(); ++i)
    if (front.pairs[i].roots != Front::Verdict::untested)
      f(Front::Waiting{0, 0, i, 0, 0, 0, Front::none, Front::none},
        front.pairs[i].roots == Front::Verdict::overlapping);
  for (const Front::Opened& opened : front.opened) {
    const TreePair& trees = trees_[opened.pair];
    const NodeRange a = trees.below_a(opened.a, opened.depth), b = trees.below_b(opened.b, opened.depth);
    for (std::uint32_t j = 0; j < b.count; ++j)
      for (std::uint32_t i = 0; i < a.count; ++i)
        f(Front::Waiting{0, 0, opened.pair, a.first + i, b.first + j, opened.depth + 1, Front::none, Front::none},
          (front.masks[opened.first_mask + j] >> i & 1) != 0);
  }
}

void FrontWalk::adopt(Front other) {
  front = std::move(other);
  opened_before_.clear();
  roots_before_.assign(front.pairs.size(), Front::none);
  for (Front::Waiting& pair : front.waiting) pair.before = Front::none;
  records_paths_ = !front.pairs.empty() && !front.pairs[0].a.spheres.empty();
}

void FrontWalk::list_finished(const CollideOptions& options, Contacts& result) {
  place(options);
  result.contacts.clear();
  result.surfaces.clear();
  each_verdict([&](const Front::Waiting& pair, bool overlapping) {
    if (overlapping && trees_[pair.pair].is_final(pair.a, pair.b, pair.depth)) report(pair, true, result);
  });
  result.finished_count = result.contacts.size();
}

void FrontWalk::cut(std::vector<FrontPair>& list) {
  using State = FrontPair::State;
  list.clear();
  if (front.pairs.empty()) return;
  trees_.clear();
  for (const ColliderPair& pair : pairs) trees_.emplace_back(*pair.a, *pair.b, front.margin, front.level);
  each_verdict([&](const Front::Waiting& pair, bool overlapping) {
    if (!overlapping) {
      list.push_back({pair.pair, pair.a, pair.b, State::separated});
    } else if (trees_[pair.pair].is_final(pair.a, pair.b, pair.depth)) {
      list.push_back({pair.pair, pair.a, pair.b, State::finished});
    }
  });
  for (std::uint32_t i = 0; i < front.pairs.size(); ++i)
    if (front.pairs[i].roots == Front::Verdict::untested) list.push_back({i, 0, 0, State::waiting});
  for (const Front::Waiting& pair : front.waiting) list.push_back({pair.pair, pair.a, pair.b, State::waiting});
}

// Links in lists go from later pairs to earlier ones, and links down go to later ones: so there are no cycles.
bool FrontWalk::is_well_formed() const {
  const std::size_t count = front.opened.size();
  const auto has_node = [&](std::uint32_t bodies, std::uint32_t a, std::uint32_t b) {
    return bodies < pairs.size() && a < front.pairs[bodies].a.spheres.size() &&
           b < front.pairs[bodies].b.spheres.size();
  };
  for (std::uint32_t i = 0; i < front.pairs.size(); ++i) {
    const std::uint32_t roots = front.pairs[i].opened_roots;
    if (roots == Front::none) continue;
    if (roots >= count) return false;
    const Front::Opened& pair = front.opened[roots];
    if (pair.pair != i || pair.a != 0 || pair.b != 0 || pair.depth != 0) return false;
  }
  for (const Front::Waiting& pair : front.waiting)
    if (!has_node(pair.pair, pair.a, pair.b) || (pair.above != Front::none && pair.above >= count)) return false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Front::Opened& pair = front.opened[i];
    if (!has_node(pair.pair, pair.a, pair.b)) return false;
    if (pair.next_beside != Front::none && pair.next_beside >= i) return false;
    const SphereTree& tree_a = pairs[pair.pair].a->tree();
    const SphereTree& tree_b = pairs[pair.pair].b->tree();
    const auto below = [&](const SphereTree& tree, std::uint32_t node) {
      return pair.depth < front.level && tree.child_count[node] > 0
                 ? NodeRange{tree.first_child[node], tree.child_count[node]}
                 : NodeRange{node, 1};
    };
    const NodeRange below_a = below(tree_a, pair.a), below_b = below(tree_b, pair.b);
    if (pair.first_mask > front.masks.size() || front.masks.size() - pair.first_mask < below_b.count) return false;
    for (std::uint32_t j = 0; j < below_b.count && below_a.count < 64; ++j)
      if (front.masks[pair.first_mask + j] >> below_a.count != 0) return false;
    if (pair.first_below != Front::none && pair.first_below <= i) return false;
    for (std::uint32_t k = pair.first_below; k != Front::none; k = front.opened[k].next_beside) {
      if (k >= count) return false;
      const Front::Opened& child = front.opened[k];
      if (child.pair != pair.pair || child.depth != pair.depth + 1 || !holds(below_a, child.a) ||
          !holds(below_b, child.b) || (child.next_beside != Front::none && child.next_beside >= k))
        return false;
    }
  }
  return true;
}

}  // namespace morula::detail
