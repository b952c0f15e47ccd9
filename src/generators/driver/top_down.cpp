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

LevelDivision divide_level(const std::vector<BuildNode>& level, const BuildRun& run, const Divider& divide,
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
  std::string note = "the time limit of " + short_number(run.time_limit_seconds) + " s was over: undivided are " +
                     std::to_string(undivided) + " of the " + std::to_string(of) + " nodes of level " +
                     std::to_string(level);
  if (below > 0) note += " and all " + std::to_string(below) + " of level " + std::to_string(level + 1);
  report.notes.push_back(std::move(note));
  report.complete = false;
}

}  // namespace

CoveredTree top_down(const Mesh& mesh, const BuildRun& run, const Box& root_cell, const Divider& divide,
                     Workers& workers, const SignedDistance* shape, const ObjectLines* lines,
                     const LevelHook& new_level, const std::function<void()>& divided) {
  run.throw_if_stopped();
  if (run.spheres > 0 || run.max_protrusion > 0) {
    if (shape) return best_first(mesh, run, root_cell, divide, *shape, workers);
    return best_first(mesh, run, root_cell, divide, SignedDistance(mesh, workers), workers);
  }
  run.tell(0, 0);
  CoveredTree built;
  BuildReport& report = built.report = new_report(mesh, run);
  built.tree.branching = report.branching;

  Winners winners;
  std::vector<Sphere> settled;   // of leaves above the level in work
  std::vector<Region> finished;  // one per node of the tree; only leaves keep theirs
  std::vector<BuildNode> level{root_node(mesh, run, root_cell)};
  built.tree.append_level({}, std::span(&level[0].sphere, 1));
  TimeEstimate estimate(run.depth, run.branching, level[0].region.size(), workers.thread_count());
  const double too_small = smallest_radius(run);
  double told = run.seconds();
  report.level_seconds.push_back(told);

  for (int depth = 0; depth < run.depth && !level.empty() && report.complete; ++depth) {
    LevelDivision made = divide_level(level, run, divide, too_small, estimate, workers);
    std::vector<BuildNode> next;
    for (std::size_t i = 0; i < level.size(); ++i) {
      Division& division = made.divisions[i];
      report.leftover_patches += division.leftover_patches;
      winners.add(division);
      for (BuildNode& child : division.children) {
        child.parent = static_cast<std::uint32_t>(i);
        next.push_back(std::move(child));
      }
    }
    if (new_level && !next.empty()) new_level(next);
    // mutant levels-monotone: `lines` -> `lines && next.empty()`
    if (lines) {
      const bool last = depth + 1 == run.depth;
      keep_monotone(mesh, *lines, run.largest_coordinate(), settled, level, next, last);
    }
    std::vector<std::uint32_t> child_counts(level.size(), 0);
    std::vector<Sphere> spheres;
    for (const BuildNode& node : next) {
      ++child_counts[node.parent];
      spheres.push_back(node.sphere);
    }
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (child_counts[i] == 0) settled.push_back(level[i].sphere);
      finished.push_back(child_counts[i] == 0 ? std::move(level[i].region) : Region{});
    }
    if (!next.empty()) built.tree.append_level(child_counts, spheres);
    report.level_seconds.push_back(run.seconds() - told);
    told = run.seconds();
    if (made.undivided > 0)
      note_time_limit(run, made.undivided, level.size(), depth + 1 < run.depth ? next.size() : 0, report);
    level = std::move(next);
  }
  for (BuildNode& node : level) finished.push_back(std::move(node.region));
  report.level_seconds.resize(built.tree.level_count());
  if (divided) divided();
  built.cover = assemble_cover(mesh, built.tree, std::move(finished));
  for (std::uint32_t i = 0; i < built.tree.level_begin[built.tree.level_count() - 1]; ++i)
    report.early_leaves += built.tree.is_leaf(i);
  if (report.complete && built.tree.level_count() < static_cast<std::size_t>(run.depth) + 1)
    report.notes.push_back("the surface cannot be divided further: the tree ends at level " +
                           std::to_string(built.tree.level_count() - 1) + " of " + std::to_string(run.depth));
  if (std::string note = winners.note(); !note.empty()) report.notes.push_back(std::move(note));
  run.tell(1, static_cast<int>(built.tree.level_count()) - 1, 0.0);
  run.throw_if_stopped();
  return built;
}

}  // namespace morula::detail
