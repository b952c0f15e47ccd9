// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What a study holds, and how it is looked up.
#include "study/run.hpp"

namespace morula::cli {

const StudyCell* StudyResult::find(std::string_view body, std::string_view method, std::string_view motion,
                                   std::string_view rule) const {
  for (const StudyCell& cell : cells)
    if (cell.body == body && cell.method == method && cell.motion == motion && cell.rule == rule) return &cell;
  return nullptr;
}

const PressCell* StudyResult::find_press(std::string_view body, std::string_view method, std::string_view rule) const {
  for (const PressCell& cell : presses)
    if (cell.body == body && cell.method == method && cell.rule == rule) return &cell;
  return nullptr;
}

std::vector<TreeLevel> tree_levels(const Mesh& mesh, const Built& built) {
  std::vector<bool> used(mesh.vertex_count(), false);
  for (const Facet& facet : mesh.facets)
    for (const std::uint32_t vertex : facet) used[vertex] = true;
  const SphereTree& tree = built.tree;
  std::vector<TreeLevel> levels(tree.level_count());
  for (std::size_t level = 0; level < levels.size(); ++level) {
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      ++levels[level].nodes;
      bool empty = true;
      for (std::size_t v = 0; v < used.size() && empty; ++v)
        empty = !used[v] || power(tree.spheres[node], mesh.positions[v]) > 0;
      levels[level].void_spheres += empty ? 1 : 0;
    }
    if (level < built.report.growth.size()) levels[level].grown = built.report.growth[level].grown;
  }
  return levels;
}

std::size_t shown_tree(const StudyPlan& plan, const StudyResult& result) {
  for (std::size_t i = 0; i < result.trees.size() && result.trees[i].body == plan.bodies.front().name; ++i)
    if (result.trees[i].method == "medial") return i;
  return 0;
}

}  // namespace morula::cli
