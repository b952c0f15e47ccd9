// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/top_down.hpp"

#include <algorithm>

#include "generators/driver/driver.hpp"
#include "generators/driver/join.hpp"
#include "generators/driver/monotone.hpp"

namespace morula::detail {
namespace {

// One level's nodes and what became of them.
struct LevelDivision {
  std::vector<Division> divisions;
  std::size_t undivided = 0;  // for want of time
};

LevelDivision divide_nodes(const std::vector<BuildNode>& level, const BuildRun& run, const Divider& divide,
                           double too_small, TimeEstimate& estimate, Workers& workers) {
  LevelDivision result;
  result.divisions.resize(level.size());
  estimate.begin_level(level.size());
  // A few nodes at a time, so that progress is reported from here; results do not depend on the grouping.
  const std::size_t nodes_per_report = std::max<std::size_t>(16, 8 * std::size_t{workers.thread_count()});
  for (std::size_t begin = 0; begin < level.size(); begin += nodes_per_report) {
    const std::size_t count = std::min(nodes_per_report, level.size() - begin);
    std::vector<double> seconds(count, 0.0);
    std::vector<char> divided(count, 0);
    const auto divide_one = [&](std::size_t i) {
      const double before = run.seconds();
      if (run.stop.stop_requested() || run.out_of_time()) return;
      result.divisions[begin + i] = children_of(level[begin + i], divide, too_small);
      divided[i] = 1;
      seconds[i] = run.seconds() - before;
    };
    // A single node has the workers to itself.
    if (level.size() == 1)
      divide_one(0);
    else
      workers.run(count, divide_one);
    run.throw_if_stopped();
    std::size_t children = 0;
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
      children += result.divisions[begin + i].children.size();
      sum += seconds[i];
      result.undivided += divided[i] == 0;
    }
    estimate.add(count, children, sum);
    const std::optional<double> left = estimate.seconds_left();
    const double gone = run.seconds();
    run.tell(left ? gone / (gone + *left) : 0, level[0].level + 1, left);
    run.throw_if_stopped();
  }
  return result;
}

void note_time_limit(const BuildRun& run, std::size_t undivided, std::size_t of, std::size_t below,
                     BuildReport& report) {
  if (undivided + below == 0) return;
  const auto level = report.level_seconds.size() - 2;
  std::string note = "the time limit of " + short_number(*run.time_limit_seconds) + " s was over: undivided are " +
                     std::to_string(undivided) + " of the " + std::to_string(of) + " nodes of level " +
                     std::to_string(level);
  if (below > 0) note += " and all " + std::to_string(below) + " of level " + std::to_string(level + 1);
  report.notes.push_back(std::move(note));
  report.complete = false;
}

class LevelByLevel {
 public:
  LevelByLevel(const Mesh& mesh, const BuildRun& run, const DriverInput& input, Workers& workers)
      : mesh_(mesh),
        run_(run),
        input_(input),
        workers_(workers),
        level_{root_node(mesh, run, input.root_cell)},
        estimate_(run.depth, run.branching, level_[0].region.size(), workers.thread_count()),
        told_(run.seconds()) {
    built_.report = new_report(mesh, run);
    built_.report.level_seconds.push_back(told_);
    built_.tree.branching = built_.report.branching;
    built_.tree.append_level({}, std::span(&level_[0].sphere, 1));
  }

  CoveredTree operator()() {
    for (int depth = 0; depth < run_.depth && !level_.empty() && built_.report.complete; ++depth)
      divide_level(depth + 1 == run_.depth);
    for (BuildNode& node : level_) finished_.push_back(std::move(node.region));
    if (input_.divided) input_.divided();
    built_.cover = assemble_cover(mesh_, built_.tree, std::move(finished_));
    complete_report();
    run_.tell(1, static_cast<int>(built_.tree.level_count()) - 1, 0.0);
    run_.throw_if_stopped();
    return std::move(built_);
  }

 private:
  // Makes the children of level_ the new level_. last: they are as deep as the run goes.
  void divide_level(bool last) {
    LevelDivision made = divide_nodes(level_, run_, input_.divide, smallest_radius(run_), estimate_, workers_);
    std::vector<BuildNode> next = children_from(made.divisions);
    if (input_.new_level && !next.empty()) input_.new_level(next);
    // mutant levels-monotone: `input_.lines)` -> `input_.lines && next.empty())`
    if (input_.lines) keep_monotone(mesh_, *input_.lines, run_.largest_coordinate(), settled_, level_, next, last);
    append(next);
    built_.report.level_seconds.push_back(run_.seconds() - told_);
    told_ = run_.seconds();
    if (made.undivided > 0) note_time_limit(run_, made.undivided, level_.size(), last ? 0 : next.size(), built_.report);
    level_ = std::move(next);
  }

  std::vector<BuildNode> children_from(std::vector<Division>& divisions) {
    std::vector<BuildNode> next;
    for (std::size_t i = 0; i < divisions.size(); ++i) {
      built_.report.leftover_patches += divisions[i].leftover_patches;
      winners_.add(divisions[i]);
      for (BuildNode& child : divisions[i].children) {
        child.parent = static_cast<std::uint32_t>(i);
        next.push_back(std::move(child));
      }
    }
    return next;
  }

  // Nodes without children are leaves, and keep their regions.
  void append(const std::vector<BuildNode>& next) {
    std::vector<std::uint32_t> child_counts(level_.size(), 0);
    std::vector<Sphere> spheres;
    for (const BuildNode& node : next) {
      ++child_counts[node.parent];
      spheres.push_back(node.sphere);
    }
    for (std::size_t i = 0; i < level_.size(); ++i) {
      if (child_counts[i] == 0) settled_.push_back(level_[i].sphere);
      finished_.push_back(child_counts[i] == 0 ? std::move(level_[i].region) : Region{});
    }
    if (!next.empty()) built_.tree.append_level(child_counts, spheres);
  }

  void complete_report() {
    BuildReport& report = built_.report;
    report.level_seconds.resize(built_.tree.level_count());
    for (std::uint32_t i = 0; i < built_.tree.level_begin[built_.tree.level_count() - 1]; ++i)
      report.early_leaves += built_.tree.is_leaf(i);
    if (report.complete && built_.tree.level_count() < static_cast<std::size_t>(run_.depth) + 1)
      report.notes.push_back("the surface cannot be divided further: the tree ends at level " +
                             std::to_string(built_.tree.level_count() - 1) + " of " + std::to_string(run_.depth));
    if (std::string note = winners_.note(); !note.empty()) report.notes.push_back(std::move(note));
  }

  const Mesh& mesh_;
  const BuildRun& run_;
  const DriverInput& input_;
  Workers& workers_;
  std::vector<BuildNode> level_;  // in work
  TimeEstimate estimate_;
  double told_;  // when the level before was finished
  CoveredTree built_;
  Winners winners_;
  std::vector<Sphere> settled_;   // of leaves above the level in work
  std::vector<Region> finished_;  // one per node above the level in work; only leaves keep theirs
};

}  // namespace

CoveredTree top_down(const Mesh& mesh, const BuildRun& run, const DriverInput& input, Workers& workers) {
  run.throw_if_stopped();
  if (is_worst_first(run)) {
    if (input.distance) return best_first(mesh, run, input.root_cell, input.divide, *input.distance, workers);
    return best_first(mesh, run, input.root_cell, input.divide, SignedDistance(mesh, workers), workers);
  }
  run.tell(0, 0);
  return LevelByLevel(mesh, run, input, workers)();
}

}  // namespace morula::detail
