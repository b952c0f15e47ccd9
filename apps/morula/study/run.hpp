// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Runs a study: trees, then all cells, in parallel and out of the cache where they are there already.
#pragma once

#include <functional>
#include <morula/parallel/workers.hpp>

#include "study/cache.hpp"
#include "study/cell.hpp"
#include "study/press.hpp"

namespace morula::cli {

/// One level of one tree at rest.
struct TreeLevel {
  std::size_t nodes = 0;
  std::size_t void_spheres = 0;  // that enclose no vertex of the mesh
  std::size_t grown = 0;         // of trees from files: radii that had to grow for the tree to cover
};

struct StudyTree {
  std::string body;
  std::string method;
  std::vector<TreeLevel> levels;
};

struct StudyResult {
  std::vector<StudyTree> trees;      // one per source
  std::vector<StudyTree> needles;    // the same generators on the prism of long thin triangles
  std::vector<StudyCell> cells;      // sources × motions × rules, in that order
  std::vector<StudyCell> mixes;      // motions × mixes of the first source
  std::vector<PressCell> presses;    // sources, and those that are only pressed, × rules of the press
  std::vector<Json> truths;          // of the presses, one per body: truths_json
  std::vector<std::string> skipped;  // motions and presses that a body cannot make, and why
  std::vector<Built> shown;          // the first body's trees, one per source of it
  std::size_t taken_from_cache = 0;  // cells that were there already
  std::size_t cell_count() const { return cells.size() + mixes.size() + presses.size(); }

  /// nullptr when there is none.
  const StudyCell* find(std::string_view body, std::string_view method, std::string_view motion,
                        std::string_view rule) const;
  const PressCell* find_press(std::string_view body, std::string_view method, std::string_view rule) const;
};

/// A stop was requested; finished cells are kept.
class StudyStopped : public std::runtime_error {
 public:
  StudyStopped() : std::runtime_error("study: stopped on request") {}
};

/// `progress` is told the share done and what is being done, one call at a time, on any thread.
/// The same figures for any number of workers, and however often the study was interrupted. Throws StudyStopped;
/// std::invalid_argument and FileError for trees that do not fit their mesh.
StudyResult run_study(const StudyPlan& plan, const StudyCache& cache, Workers& workers, const std::stop_token& stop,
                      const std::function<void(double, std::string)>& progress);

/// Nodes per level, and how many of them are void.
std::vector<TreeLevel> tree_levels(const Mesh& mesh, const Built& built);

/// Which of the first body's trees stands for it in pictures and costs: the medial one, else the first.
std::size_t shown_tree(const StudyPlan& plan, const StudyResult& result);

}  // namespace morula::cli
