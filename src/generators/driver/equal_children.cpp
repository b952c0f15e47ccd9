// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/equal_children.hpp"

#include <algorithm>

namespace morula::detail {
namespace {

// The outside volume of such a child is that of the node, to half a percent.
bool is_equal(const Sphere& child, const Sphere& node) {
  constexpr double share = 0.001;
  // mutant equal-children-wherever-they-are: `node.radius && ... * node.radius` -> `node.radius`
  return child.radius >= (1 - share) * node.radius && distance(child.center, node.center) <= share * node.radius;
}

// Flags of the nodes that become leaves. Children have higher numbers than their parents.
std::vector<std::uint8_t> nodes_with_equal_children(const SphereTree& tree, bool root_too) {
  std::vector<std::uint8_t> ends(tree.node_count());
  for (std::uint32_t node = static_cast<std::uint32_t>(tree.node_count()); node-- > (root_too ? 0u : 1u);) {
    if (tree.is_leaf(node)) continue;
    for (std::uint32_t c = tree.first_child[node]; c < tree.first_child[node] + tree.child_count[node]; ++c)
      // mutant equal-children-kept: `1` -> `0`
      if ((tree.is_leaf(c) || ends[c] != 0) && is_equal(tree.spheres[c], tree.spheres[node])) ends[node] = 1;
  }
  return ends;
}

}  // namespace

std::size_t remove_equal_children(CoveredTree& model, bool root_too) {
  const SphereTree& tree = model.tree;
  const std::vector<std::uint8_t> ends = nodes_with_equal_children(tree, root_too);
  SphereTree result;
  result.branching = tree.branching;
  Cover& cover = model.cover;
  std::vector<std::uint32_t> region_begin, region_end;
  std::size_t removed = 0;
  for (std::vector<std::uint32_t> level{0}, counts; !level.empty();) {
    std::vector<Sphere> spheres;
    for (const std::uint32_t node : level) {
      spheres.push_back(tree.spheres[node]);
      region_begin.push_back(cover.region_begin[node]);
      region_end.push_back(cover.region_end[node]);
    }
    result.append_level(counts, spheres);
    counts.clear();
    std::vector<std::uint32_t> next;
    for (const std::uint32_t node : level) {
      removed += ends[node];
      counts.push_back(ends[node] != 0 ? 0 : tree.child_count[node]);
      for (std::uint32_t c = 0; c < counts.back(); ++c) next.push_back(tree.first_child[node] + c);
    }
    level = std::move(next);
  }
  if (removed == 0) return 0;
  model.tree = std::move(result);
  cover.region_begin = std::move(region_begin);
  cover.region_end = std::move(region_end);
  BuildReport& report = model.report;
  report.level_seconds.resize(std::min(report.level_seconds.size(), model.tree.level_count()));
  report.early_leaves = 0;
  for (std::uint32_t i = 0; i < model.tree.level_begin[model.tree.level_count() - 1]; ++i)
    report.early_leaves += model.tree.is_leaf(i);
  return removed;
}

}  // namespace morula::detail
