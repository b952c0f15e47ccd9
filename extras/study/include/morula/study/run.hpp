// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Run of a study: builds the trees of a plan, then computes all its cells (a tree with a motion and a rule, or a press)
// in parallel. It takes cells from a cache if they are there.
//
//   morula::study::Plan plan{.bodies = {{"limb", mesh}}, .motions = morula::study::paper_motions()};
//   plan.sources = morula::study::sources_of(plan.bodies, {morula::Method::medial, morula::Method::optimized});
//   plan.rules = {morula::Rule::approach2, morula::Rule::exact};
//   const morula::study::Cache cache("study-cache");  // a later run takes finished cells from it
//   const morula::study::Result result = morula::study::run(plan, morula::serial_workers(), {.cache = &cache});
//   std::printf("%zu cells, %zu from the cache\n", result.cell_count(), result.taken_from_cache);
#pragma once

#include <functional>
#include <morula/parallel/threads.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/study/cache.hpp>
#include <morula/study/cell.hpp>
#include <morula/study/press.hpp>
#include <stdexcept>
#include <string>

namespace morula::study {

/// A function that gets the completed share of the work, 0 to 1, and the present step as text. It is called on any
/// thread, one call at a time.
using Progress = std::function<void(double share, std::string what)>;

/// The part of a run that one of several machines takes: every `count`-th tree, from `number` - 1 on, with all its
/// cells.
struct RunShard {
  std::size_t number = 1, count = 1;

  bool has(std::size_t source) const { return source % count == number - 1; }
};

struct RunOptions {
  const Cache* cache = nullptr;  ///< cache from which to take cells, and in which to keep new ones; nullptr: none
  StopToken stop{};              ///< a stop request makes run() throw Stopped
  Progress progress{};           ///< may be empty
  RunShard shard{};              ///< a part needs a cache, from which a whole run joins all parts
};

struct Result;

/// Runs a study. The figures are the same for any number of workers, and if the run was stopped and run again with its
/// cache; times differ. Throws std::invalid_argument for a plan that refers to missing entries, and for a shard without
/// a cache; FileError or std::invalid_argument for a tree file that does not belong to its mesh; and Stopped on a stop
/// request. The result of a shard has only its cells.
Result run(const Plan& plan, Workers& workers = serial_workers(), const RunOptions& options = {});

/// The exception of run() after a stop request. The cache, if there is one, keeps the finished cells.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("study: stopped on request") {}
};

/// Counts of one level of one tree at rest.
struct TreeLevel {
  std::size_t nodes = 0;
  std::size_t void_spheres = 0;  ///< number of spheres that enclose no vertex of the mesh
  std::size_t grown = 0;         ///< for trees from files: number of spheres that had to grow so that the tree covers
};

/// The work of one update of all levels, counted: the same on every machine. Formulas: src/run/counts.cpp.
struct UpdateCounts {
  std::string name;               ///< name of the rule, or "boxes"
  std::size_t points_read = 0;    ///< vertices and corners, once for each time that a node reads one
  std::size_t children_read = 0;  ///< spheres or boxes of children, counted alike
  std::size_t distances = 0;      ///< distances and squared distances to points, to children and to corners of boxes
  std::size_t bytes_read = 0, bytes_written = 0;

  std::size_t bytes() const { return bytes_read + bytes_written; }
};
/// The work of boxes and of `traditional`, `weighted`, `approach1`, `approach2` and `exact` over a tree; that of
/// `exact` is an upper bound.
std::vector<UpdateCounts> count_updates(const Mesh& mesh, const CoveredTree& model);

/// Counts of one tree.
struct TreeFigures {
  std::size_t source = 0;  ///< index in Plan::sources
  std::vector<TreeLevel> levels;
  /// Time of the build, seconds; 0 for a tree from a file or from the cache, and if the plan requests no times.
  double build_seconds = 0;
  std::vector<UpdateCounts> counts{};  ///< work of updates; empty for prisms

  /// The counts of a rule or of boxes; nullptr if they were not counted.
  const UpdateCounts* find_counts(std::string_view name) const;
};

/// A motion or press that is impossible for a body.
struct Skipped {
  std::size_t body = 0;  ///< index in Plan::bodies
  std::string reason;
};

/// The results of a study.
struct Result {
  std::vector<TreeFigures> trees;    ///< one per source
  std::vector<TreeFigures> needles;  ///< trees of the same generators on needle_prism()
  std::vector<MotionRun> cells;      ///< cells of motions and rules, ascending by key, without impossible ones
  std::vector<MotionRun> mixes;      ///< cells of the first source with each motion and each of Plan::mixes
  std::vector<PressCell> presses;    ///< cells of presses, ascending by body
  std::vector<PressScene> scenes;    ///< presses of each pressed body
  std::vector<Skipped> skipped;      ///< impossible motions and presses
  /// One tree per source. Trees of other bodies than the first are empty unless Plan::keep_trees is set.
  std::vector<CoveredTree> model;
  std::size_t taken_from_cache = 0;  ///< number of cells that came from the cache

  /// Number of all cells: motions with rules, mixes, presses.
  std::size_t cell_count() const { return cells.size() + mixes.size() + presses.size(); }
  /// The entry of `cells` with this key; nullptr if there is none.
  const MotionRun* find(const MotionRunKey& key) const;
};

/// The counts of each level of a tree of this mesh, from the root.
std::vector<TreeLevel> tree_levels(const Mesh& mesh, const CoveredTree& model);

/// The index of the source whose tree stands for the first body in pictures and costs: its medial tree, or its first
/// tree if there is no medial one.
std::size_t shown_tree(const Plan& plan);

}  // namespace morula::study
