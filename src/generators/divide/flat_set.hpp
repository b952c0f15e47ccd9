// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Flat set: so many spheres instead of a depth, all sought at once as the children of one node.
#pragma once

#include <map>

#include "generators/divide/node_fit.hpp"
#include "generators/driver/top_down.hpp"
#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Most spheres that are sought at once. More are grown from the worst leaf on (best_first).
inline constexpr std::size_t most_at_once = 256;

/// Lattice cells along the longest side by which sets are compared and improved.
inline constexpr int flat_set_cells = 192;

/// How a flat set is made: dividers into at most so many children and into two; the divider of a tree of so many
/// levels; and how parts of a new level change hands. What they do may not depend on run.spheres: a set is compared
/// with those of other numbers.
struct FlatSetBy {
  std::function<Divider(std::size_t most)> one_level;
  Divider halves;
  std::function<Divider(int depth)> levels;
  LevelHook improve;  ///< none: they do not
  bool quick;         ///< trees are tried on all bodies
  bool halfway;       ///< numbers halfway between powers of two are sought, too, and sets are divided everywhere
};

/// What fits of a level of so many spheres go by. The lattice depends on that number alone.
class LevelInputs {
 public:
  /// Borrows all.
  LevelInputs(const Mesh& mesh, const ObjectShape& shape, Workers& workers);
  const FitInput& of(std::size_t spheres);

 private:
  struct OfCells {
    ObjectLines lines;
    FitInput input;
    OfCells(const Mesh& mesh, const ObjectShape& shape, int cells, Workers& workers);
  };
  const Mesh& mesh_;
  const ObjectShape& shape_;
  Workers& workers_;
  std::map<int, OfCells> of_cells_;
};

/// The tree whose leaves are at most run.spheres spheres. input: of flat_set_cells; sets are compared and joined by it.
///
/// On slender bodies, where spheres cut slabs, the leaves of a tree are tried, too. Sets are compared by the volume of
/// their union outside the object. A set of N is never looser than one of fewer spheres, nor than one level of as many
/// children where N is 2, 3, 4, 6, 8, 16, 32, 64 … Where more spheres would be looser, fewer are returned.
CoveredTree flat_set(const FitInput& input, const BuildRun& run, const FlatSetBy& by, Workers& workers);
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
}  // namespace morula::detail
