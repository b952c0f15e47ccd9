// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Run of a study: trees, then all cells, in parallel, and from the cache if it has them.
#pragma once

#include <functional>
#include <morula/parallel/workers.hpp>
#include <morula/study/cache.hpp>
#include <morula/study/cell.hpp>
#include <morula/study/press.hpp>
#include <stdexcept>
#include <stop_token>
#include <string>

namespace morula::study {

/// One level of one tree at rest.
struct TreeLevel {
  std::size_t nodes = 0;
  std::size_t void_spheres = 0;  ///< spheres that enclose no vertex of the mesh
  std::size_t grown = 0;         ///< for trees from files: radii that had to grow for the tree to cover
};

/// The work of one update of all levels, counted: the same on every machine. Formulas: src/run/counts.cpp.
struct UpdateCounts {
  std::string name;               ///< the rule's, or "boxes"
  std::size_t points_read = 0;    ///< vertices and corners, once for each time that a node reads one
  std::size_t children_read = 0;  ///< spheres or boxes of children, counted alike
  std::size_t distances = 0;      ///< distances and squared distances to points, to children and to corners of boxes
  std::size_t bytes_read = 0, bytes_written = 0;

  std::size_t bytes() const { return bytes_read + bytes_written; }
};
/// The work of boxes and of `traditional`, `weighted`, `approach1` and `approach2` over a tree.
std::vector<UpdateCounts> count_updates(const Mesh& mesh, const CoveredTree& model);

struct TreeFigures {
  std::size_t source = 0;
  std::vector<TreeLevel> levels;
  double build_seconds = 0;            ///< seconds of the build, if the plan requests times
  std::vector<UpdateCounts> counts{};  ///< work of updates; empty for prisms

  /// nullptr if it was not counted.
  const UpdateCounts* find_counts(std::string_view name) const;
};

/// A motion or press that is impossible for a body, and the reason.
struct Skipped {
  std::size_t body = 0;
  std::string reason;
};

struct Result {
  std::vector<TreeFigures> trees;    ///< one per source
  std::vector<TreeFigures> needles;  ///< trees of the same generators on the prism of long thin triangles
  std::vector<MotionRun> cells;      ///< ascending by key, without impossible ones
  std::vector<MotionRun> mixes;      ///< motions × mixes of the first source
  std::vector<PressCell> presses;    ///< ascending by body
  std::vector<PressScene> scenes;    ///< scenes of the presses, one per pressed body
  std::vector<Skipped> skipped;
  std::vector<CoveredTree> model;    ///< one per source; empty except for the first body's, unless the plan keeps them
  std::size_t taken_from_cache = 0;  ///< cells that came from the cache

  std::size_t cell_count() const { return cells.size() + mixes.size() + presses.size(); }
  /// The run with this key; nullptr if there is none.
  const MotionRun* find(const MotionRunKey& key) const;
};

/// A stop was requested; finished cells are kept.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("study: stopped on request") {}
};

/// Called with the completed share and the present step, one call at a time, on any thread.
using Progress = std::function<void(double share, std::string what)>;

/// The part of a run that one of several machines takes: every `count`-th tree, from `number` - 1 on, with all its
/// cells.
struct RunShard {
  std::size_t number = 1, count = 1;

  bool has(std::size_t source) const { return source % count == number - 1; }
};

struct RunOptions {
  const Cache* cache = nullptr;  ///< nullptr: no cache
  std::stop_token stop{};
  Progress progress{};  ///< may be empty
  RunShard shard{};     ///< a part needs a cache, from which a whole run joins all parts
};

/// Runs a study. The figures are the same for any number of workers and interruptions; times differ. Throws Stopped;
/// std::invalid_argument and FileError for trees that do not fit their mesh; std::invalid_argument for a plan that
/// refers to missing entries, and for a shard without a cache. The result of a shard has only its cells.
Result run(const Plan& plan, Workers& workers = serial_workers(), const RunOptions& options = {});

/// Nodes and void spheres per level.
std::vector<TreeLevel> tree_levels(const Mesh& mesh, const CoveredTree& model);

/// The first body's tree that represents it in pictures and costs: the medial tree, otherwise the first.
std::size_t shown_tree(const Plan& plan);

}  // namespace morula::study
