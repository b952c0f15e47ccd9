// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Flat set: so many spheres instead of a depth, all sought at once as the children of one node.
#pragma once

#include "generators/divide/node_fit.hpp"
#include "generators/driver/top_down.hpp"

namespace morula::detail {

/// Most spheres that are sought at once. More are grown from the worst leaf on (best_first).
inline constexpr std::size_t most_at_once = 256;

/// So many spheres are best sought at once; more may grow from smaller sets.
inline constexpr std::size_t few_spheres = 8;

/// The smallest of the sizes 12, 16, 24, 48 … that are also sought by another start, where a method has one.
inline constexpr std::size_t least_other_start = 3 * few_spheres / 2;

/// Lattice cells along the longest side by which sets are compared and improved.
inline constexpr int flat_set_cells = 192;

/// Dividers that make a flat set. Those with `most` divide a node into at most so many children.
struct FlatSetBy {
  std::function<Divider(std::size_t most)> one_level;  ///< the divider of a tree of one level
  /// Seeks sets of 12, 16, 24, 48 … spheres in another way, for larger sets to grow from; none: nothing does.
  std::function<Divider(std::size_t most)> other_start = {};
  std::function<Divider(std::size_t most)> parts;  ///< divides one sphere of a set
  std::function<Divider(int depth)> levels;        ///< of a tree of so many levels; none: no trees are tried
  LevelHook improve;                               ///< lets parts of a new level change hands; none: they do not
  bool grows = false;                              ///< smaller sets grow, and compete with sets sought at once
  bool quick = false;                              ///< trees are tried on all bodies
};

/// The tree whose leaves are at most run.spheres spheres. lines: what sets are compared by.
///
/// The set is the tightest of: as many spheres as are wanted, sought at once; the leaves of a tree, where by.levels has
/// one; and the set of 2, 3, 4, 6, 8, 16, 32, 64 … spheres below, grown by dividing the worst sphere, by way of one
/// that by.other_start seeks at 12, 16, 24, 48 …, where that is tighter. Sets are compared by the volume of their union
/// outside the object. Where more spheres would be looser, fewer are returned.
/// So a set of N is never looser than one level of N children, nor than a set of one of those numbers. It may be
/// looser than one of another smaller number that was sought at once and is tighter than what had grown.
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
inline int cells_for(const BuildRun& run, const MeshView& mesh, const ObjectShape& shape) {
  return is_flat_set(run) ? lattice_cells(mesh, shape, static_cast<int>(run.spheres), 1)
                          : lattice_cells(mesh, shape, run.branching, run.depth);
}

}  // namespace morula::detail
