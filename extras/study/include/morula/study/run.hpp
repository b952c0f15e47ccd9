// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Running a study: trees, then all cells, in parallel and out of the cache where they are there already.
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
  std::size_t void_spheres = 0;  ///< that enclose no vertex of the mesh
  std::size_t grown = 0;         ///< of trees from files: radii that had to grow for the tree to cover
};

struct TreeFigures {
  std::size_t source = 0;
  std::vector<TreeLevel> levels;
  double build_seconds = 0;  ///< when the plan asks for times
};

/// A motion or a press that a body cannot make, and why.
struct Skipped {
  std::size_t body = 0;
  std::string reason;
};

struct Result {
  std::vector<TreeFigures> trees;    ///< one per source
  std::vector<TreeFigures> needles;  ///< the same generators on the prism of long thin triangles
  std::vector<Run> cells;            ///< ascending by key; those that cannot be made are left out
  std::vector<Run> mixes;            ///< motions × mixes of the first source
  std::vector<PressCell> presses;    ///< ascending by body
  std::vector<PressScene> scenes;    ///< of the presses, one per body that is pressed
  std::vector<Skipped> skipped;
  std::vector<CoveredTree> model;    ///< one per source; empty but for the first body's, unless the plan keeps them
  std::size_t taken_from_cache = 0;  ///< cells that were there already

  std::size_t cell_count() const { return cells.size() + mixes.size() + presses.size(); }
  /// nullptr when there is none.
  const Run* find(const RunKey& key) const;
};

/// A stop was requested; finished cells are kept.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("study: stopped on request") {}
};

/// Called with the share done and what is being done, one call at a time, on any thread.
using Progress = std::function<void(double share, std::string what)>;

struct RunOptions {
  const Cache* cache = nullptr;  ///< nullptr: nothing is kept
  std::stop_token stop{};
  Progress progress{};  ///< or none
};

/// The same figures for any number of workers, and however often the study was interrupted; times differ.
/// Throws Stopped; std::invalid_argument and FileError for trees that do not fit their mesh; std::invalid_argument for
/// a plan that names what is not in it.
Result run(const Plan& plan, Workers& workers = serial_workers(), const RunOptions& options = {});

/// Nodes per level, and how many of them are void.
std::vector<TreeLevel> tree_levels(const Mesh& mesh, const CoveredTree& model);

/// Which of the first body's trees stands for it in pictures and costs: the medial one, else the first.
std::size_t shown_tree(const Plan& plan);

}  // namespace morula::study
