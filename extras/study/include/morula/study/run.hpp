// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Run of a study: trees, then all cells, in parallel, and from the cache if it has them.
//
//   morula::study::Plan plan{.bodies = {{"limb", mesh}}, .motions = morula::study::paper_motions()};
//   plan.sources = morula::study::sources_of(plan.bodies, {morula::Method::medial, morula::Method::optimized});
//   plan.rules = {morula::Rule::approach2, morula::Rule::exact};
//   const morula::study::Cache cache("study-cache");  // a later run takes finished cells from it
//   const morula::study::Result result = morula::study::run(plan, morula::serial_workers(), {.cache = &cache});
//   std::printf("%zu cells, %zu from the cache\n", result.cell_count(), result.taken_from_cache);
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

/// Called with the completed share and the present step, one call at a time, on any thread.
using Progress = std::function<void(double share, std::string what)>;

struct RunOptions {
  const Cache* cache = nullptr;  ///< nullptr: no cache
  std::stop_token stop{};
  Progress progress{};  ///< may be empty
};

struct Result;

/// Runs a study. The figures are the same for any number of workers and interruptions; times differ. Throws Stopped;
/// std::invalid_argument and FileError for trees that do not fit their mesh; std::invalid_argument for a plan that
/// refers to missing entries.
Result run(const Plan& plan, Workers& workers = serial_workers(), const RunOptions& options = {});

/// A stop was requested; finished cells are kept.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("study: stopped on request") {}
};

/// One level of one tree at rest.
struct TreeLevel {
  std::size_t nodes = 0;
  std::size_t void_spheres = 0;  ///< spheres that enclose no vertex of the mesh
  std::size_t grown = 0;         ///< for trees from files: radii that had to grow for the tree to cover
};

struct TreeFigures {
  std::size_t source = 0;
  std::vector<TreeLevel> levels;
  /// Seconds of the build; 0 for a tree from a file or from the cache, and if the plan requests no times.
  double build_seconds = 0;
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

/// Nodes and void spheres per level.
std::vector<TreeLevel> tree_levels(const Mesh& mesh, const CoveredTree& model);

/// The first body's tree that represents it in pictures and costs: the medial tree, otherwise the first.
std::size_t shown_tree(const Plan& plan);

}  // namespace morula::study
