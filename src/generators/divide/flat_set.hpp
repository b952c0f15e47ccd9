// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Flat set: a number of spheres instead of a depth, all sought at once as the children of one node.
#pragma once

#include "generators/divide/node_fit.hpp"
#include "generators/driver/top_down.hpp"

namespace morula::detail {

/// Most spheres that are sought at once. Larger sets are grown by dividing the worst leaf (best_first).
inline constexpr std::size_t most_at_once = 256;

/// Sets of so few spheres are best sought at once; larger ones may grow from smaller sets.
inline constexpr std::size_t few_spheres = 8;

/// The smallest of the sizes 12, 16, 24, 48 … that are also sought by another start, if a method has one.
inline constexpr std::size_t least_other_start = 3 * few_spheres / 2;

/// Lattice cells along the longest side by which sets are compared and improved.
inline constexpr int flat_set_cells = 192;

/// Dividers that make a flat set. Dividers with `most` divide a node into at most so many children.
struct FlatSetBy {
  std::function<Divider(std::size_t most)> one_level;  ///< the divider of a tree of one level
  /// Seeks sets of 12, 16, 24, 48 … spheres in another way, for larger sets to grow from; empty: there is no other way.
  std::function<Divider(std::size_t most)> other_start = {};
  std::function<Divider(std::size_t most)> parts;  ///< divides one sphere of a set
  std::function<Divider(int depth)> levels;  ///< the divider of a tree of `depth` levels; empty: no trees are tried
  LevelHook improve;                         ///< exchanges parts between the nodes of a new level; empty: no exchange
  bool grows = false;                        ///< smaller sets grow, and compete with sets sought at once
  bool quick = false;                        ///< trees are tried on all bodies
};

/// Returns the tree whose leaves are at most run.spheres spheres. lines: the lattice by which sets are compared.
///
/// The set is the tightest of three: the requested number of spheres, sought at once; the leaves of a tree, if there is
/// by.levels; and the set of 2, 3, 4, 6, 8, 16, 32, 64 … spheres below, grown by dividing the worst sphere. The grown
/// set starts from one that by.other_start seeks at 12, 16, 24, 48 … spheres, if that one is tighter. Sets are compared
/// by the volume of their union outside the object. If more spheres would be looser, fewer are returned.
/// So a set of N is never looser than one level of N children, nor than a set of one of those numbers. It may be looser
/// than a set of another smaller number that was sought at once and is tighter than the grown set.
CoveredTree flat_set(const FitInput& input, const ObjectLines& lines, const BuildRun& run, const FlatSetBy& by,
                     Workers& workers);
/// Whether flat_set() makes this run's tree.
inline bool is_flat_set(const BuildRun& run) {
  return run.spheres > 1 && run.spheres <= most_at_once && run.max_protrusion == 0;
}
/// A run of a tree of `depth` levels instead. It reports no progress.
inline BuildRun of_levels(const BuildRun& run, int depth) {
  BuildRun tree = run;
  tree.spheres = 0;
  tree.depth = depth;
  tree.progress = {};
  return tree;
}
/// Cells along the longest side of the lattice for a run's fits; flat sets have those of one level.
inline int cells_for(const BuildRun& run, const MeshView& mesh, const ObjectShape& shape) {
  return is_flat_set(run) ? lattice_cells(mesh, shape, static_cast<int>(run.spheres), 1)
                          : lattice_cells(mesh, shape, run.branching, run.depth);
}

}  // namespace morula::detail
