// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Flat set: so many spheres instead of a depth, all sought at once as the children of one node.
#pragma once

#include "generators/divide/node_fit.hpp"
#include "generators/driver/top_down.hpp"

namespace morula::detail {

/// Most spheres that are sought at once. More are grown from the worst leaf on (best_first).
inline constexpr std::size_t most_at_once = 256;

/// Lattice cells along the longest side by which sets are compared and improved.
inline constexpr int flat_set_cells = 192;

/// How a flat set is made: dividers into at most so many children; the divider of a tree of so many levels; and how
/// parts of a new level change hands.
struct FlatSetBy {
  std::function<Divider(std::size_t most)> one_level;
  std::function<Divider(int depth)> levels;
  LevelHook improve;  ///< none: they do not
  bool quick;         ///< trees are tried on all bodies
};

/// The tree whose leaves are at most run.spheres spheres. lines: what sets are compared by.
///
/// On slender bodies, where spheres cut slabs, the leaves of a tree are tried, too. Sets are compared by the volume of
/// their union outside the object. A set of N is never looser than one of 1, 2, 3, 4, 6 or 8 spheres, or of 16, 32, 64
/// … below N. Where more spheres would be looser, fewer are returned.
CoveredTree flat_set(const FitInput& input, const ObjectLines& lines, const BuildRun& run, const FlatSetBy& by,
                     Workers& workers);
/// Whether flat_set makes this run's tree.
inline bool is_flat_set(const BuildRun& run) {
  return run.spheres > 1 && run.spheres <= most_at_once && run.max_protrusion == 0;
}
/// For a tree of so many levels instead. Progress is not told.
inline BuildRun of_levels(const BuildRun& run, int depth) {
  BuildRun tree = run;
  tree.spheres = 0;
  tree.depth = depth;
  tree.progress = {};
  return tree;
}
/// Cells along the longest side of the lattice that a run's fits go by: a flat set's are those of one level.
inline int cells_for(const BuildRun& run, const Mesh& mesh, const ObjectShape& shape) {
  return is_flat_set(run) ? lattice_cells(mesh, shape, static_cast<int>(run.spheres), 1)
                          : lattice_cells(mesh, shape, run.branching, run.depth);
}

}  // namespace morula::detail
