// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/top_down.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <morula/geometry/enclosing_sphere.hpp>

#include "generators/driver/driver.hpp"
#include "generators/driver/join.hpp"
#include "generators/fit/object_lines.hpp"
#include "generators/fit/union_lines.hpp"

namespace morula::detail {
namespace {

using Numbers = std::vector<std::uint32_t>;

// A sphere around a child's region and inside its parent's: as near to the child's own center as the parent's sphere
// allows.
Sphere inside_parent(const MeshView& mesh, const BuildNode& child, const Sphere& parent, double pad) {
  std::vector<Vec3> corners;
  corner_positions(mesh, child.region, corners);
  constexpr int steps = 8;
  for (int step = steps; step > 0; --step) {
    const Vec3 center = parent.center + (child.sphere.center - parent.center) * (static_cast<double>(step) / steps);
    const double radius = rounded_up_radius(farthest_distance(center, corners), std::max(pad, max_norm(center)));
    if (distance(center, parent.center) + radius <= parent.radius) return {center, radius};
  }
  // No larger than the parent's, except for the rounding of points that the child's polygons have been cut at.
  return {parent.center,
          rounded_up_radius(farthest_distance(parent.center, corners), std::max(pad, max_norm(parent.center)))};
}

double signed_area(std::span<const Barycentric> polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Barycentric &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a[0] * b[1] - a[1] * b[0];
  }
  return 0.5 * twice;
}

// Regions as one. A facet is whole again when its patches have all of its area, up to rounding, and its three corners:
// then nothing new is owned. A patch that exchange moved elsewhere is missing, however small: it may have a corner of
// the facet, and that corner need not lie in the node's sphere.
Region joined(std::span<const BuildNode> parts) {
  constexpr double whole = 0.5 * (1 - 1e-12);
  struct FacetPatches {
    double area = 0;
    std::size_t count = 0;
    unsigned corners = 0;  // corners of the facet, a bit each
  };
  std::map<std::uint32_t, FacetPatches> patches;
  for (const BuildNode& part : parts)
    for (std::size_t k = 0; k < part.region.size(); ++k) {
      FacetPatches& of = patches[part.region.facet[k]];
      of.area += std::abs(signed_area(part.region.polygon(k)));
      ++of.count;
      for (const Barycentric& b : part.region.polygon(k))
        for (std::size_t i = 0; i < 3; ++i)
          if (b[i] == 1 && b[(i + 1) % 3] == 0 && b[(i + 2) % 3] == 0) of.corners |= 1u << i;
    }
  Region region;
  for (const BuildNode& part : parts)
    for (std::size_t k = 0; k < part.region.size(); ++k) {
      FacetPatches& of = patches[part.region.facet[k]];
      if (of.area < whole || of.corners != 7)
        region.add(part.region.facet[k], part.region.polygon(k));
      else if (of.count > 0)
        region.add_whole(part.region.facet[k]), of.count = 0;
    }
  return region;
}

class Levels {
 public:
  Levels(const ObjectLines& lines, std::span<const Sphere> settled, const std::vector<BuildNode>& above,
         const std::vector<BuildNode>& next)
      : first_above_(static_cast<std::uint32_t>(settled.size())), children_(above.size()) {
    std::vector<Sphere> spheres(settled.begin(), settled.end());
    for (const BuildNode& node : above) spheres.push_back(node.sphere);
    const std::size_t first_below = spheres.size();
    for (const BuildNode& child : next) {
      children_[child.parent].push_back(static_cast<std::uint32_t>(spheres.size()));
      spheres.push_back(child.sphere);
    }
    lines_ = std::make_unique<UnionLines>(lines, spheres, spacing(next));
    std::vector<std::uint8_t> of_above(spheres.size(), 0);
    for (std::size_t s = 0; s < first_below; ++s) {
      lines_->count(s, true);
      of_above[s] = 1;
    }
    above_ = lines_->outside();
    for (std::size_t i = 0; i < above.size(); ++i)
      if (!children_[i].empty()) lines_->count(first_above_ + i, false);
    for (std::size_t s = first_below; s < spheres.size(); ++s) lines_->count(s, true);
    below_ = lines_->outside();
    difference_ = lines_->difference(of_above);
  }

  // Flags of the divisions that are undone.
  std::vector<std::uint8_t> taken_back() {
    std::vector<std::uint8_t> gone(children_.size(), 0);
    std::vector<std::pair<double, std::uint32_t>> order;
    const auto gains = [&] {
      order.clear();
      for (std::uint32_t i = 0; i < children_.size(); ++i)
        if (!children_[i].empty() && gone[i] == 0) order.push_back({change(i), i});
      std::sort(order.begin(), order.end());
    };
    const auto take_back = [&](std::uint32_t i, double by) {
      below_ += by;
      for (const std::uint32_t s : children_[i]) lines_->count(s, false);
      lines_->count(first_above_ + i, true);
      gone[i] = 1;
    };
    gains();
    for (const auto& [before, i] : order) {
      if (before > 0) break;
      if (const double now = change(i); now <= 0 && is_seen(i)) take_back(i, now);
    }
    while (!not_looser()) {
      gains();
      if (order.empty()) break;
      // A few at a time: each changes little for the rest.
      const std::size_t some = 1 + order.size() / 8;
      for (std::size_t k = 0; k < std::min(some, order.size()) && !not_looser(); ++k) {
        const std::uint32_t i = order[k].second;
        take_back(i, change(i));
      }
    }
    return gone;
  }

 private:
  // Change of the level's outside volume if a node replaced its children.
  double change(std::uint32_t node) {
    const std::array<std::uint32_t, 1> own{first_above_ + node};
    return lines_->change(own, children_[node]);
  }
  // A line or two cannot measure nodes that are small compared with the lattice's cells.
  bool is_seen(std::uint32_t node) const {
    constexpr std::size_t enough = 24;
    return lines_->line_count(first_above_ + node) >= enough;
  }
  // Spacing of lines: a sixth of a usual new sphere's radius. On a tube a sphere's own slab is a fifth of its radius
  // wide: lines twice as far apart miss every second slab, and useful divisions were undone.
  static double spacing(const std::vector<BuildNode>& next) {
    std::vector<double> radii;
    for (const BuildNode& child : next) radii.push_back(child.sphere.radius);
    const auto some = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), some, radii.end());
    // mutant slabs-judged: `6` -> `3`
    return *some / 6;
  }
  // The error of both unions is the error of their difference.
  bool not_looser() const {
    constexpr double error = 0.02;
    return below_ <= above_ - error * difference_;
  }

  std::uint32_t first_above_;
  std::vector<Numbers> children_;  // children of each node above
  std::unique_ptr<UnionLines> lines_;
  double above_ = 0, below_ = 0, difference_ = 0;
};

// Undoes the divisions of a new level that do not pay, then further ones until the level, as a whole, is not looser
// than the level above, as UnionLines measures it, and by more than their error.
//
// settled: spheres of leaves on levels above. above: nodes of the level above that were divided, or tried to be. next:
// the new level, after all exchange. On the last level an undone division leaves its node a leaf, which owns the
// regions of its children; they are erased from `next`, and its region is put together again. On other levels, whose
// places are needed below, and below the root, its children keep their regions and get spheres inside the node's own. A
// level without any division left is the level above, or inside it: so there is always an end. pad: for rounding radii
// up.
void keep_monotone(const MeshView& mesh, const ObjectLines& lines, double pad, std::span<const Sphere> settled,
                   std::vector<BuildNode>& above, std::vector<BuildNode>& next, bool last) {
  if (next.empty()) return;
  const std::vector<std::uint8_t> gone = Levels(lines, settled, above, next).taken_back();
  if (std::none_of(gone.begin(), gone.end(), [](std::uint8_t g) { return g != 0; })) return;
  // A ball is as tight as its parts, but parts that move apart have to be parts: the root always stays divided.
  if (!last || above[0].level == 0) {
    for (std::size_t k = 0; k < next.size(); ++k)
      if (const std::uint32_t parent = next[k].parent; gone[parent] != 0)
        next[k].sphere = inside_parent(mesh, next[k], above[parent].sphere, pad);
    return;
  }
  // Children of one node are adjacent.
  for (std::size_t begin = 0; begin < next.size();) {
    std::size_t end = begin;
    while (end < next.size() && next[end].parent == next[begin].parent) ++end;
    if (gone[next[begin].parent] != 0)
      above[next[begin].parent].region = joined(std::span(next).subspan(begin, end - begin));
    begin = end;
  }
  std::erase_if(next, [&](const BuildNode& child) { return gone[child.parent] != 0; });
}

// One level's nodes and their divisions.
struct LevelDivision {
  std::vector<Division> divisions;
  std::size_t undivided = 0;  // nodes left undivided for lack of time
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
  LevelByLevel(const MeshView& mesh, const BuildRun& run, const DriverInput& input, Workers& workers)
      : mesh_(mesh),
        run_(run),
        input_(input),
        workers_(workers),
        level_{root_node(mesh, run, input.root_cell)},
        estimate_(run.depth, run.branching, level_[0].region.size(), workers.thread_count()),
        last_report_(run.seconds()) {
    built_.report = new_report(mesh, run);
    built_.report.level_seconds.push_back(last_report_);
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
    built_.report.level_seconds.push_back(run_.seconds() - last_report_);
    last_report_ = run_.seconds();
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

  MeshView mesh_;
  const BuildRun& run_;
  const DriverInput& input_;
  Workers& workers_;
  std::vector<BuildNode> level_;  // nodes of the current level
  TimeEstimate estimate_;
  double last_report_;  // when the last level was finished
  CoveredTree built_;
  Winners winners_;
  std::vector<Sphere> settled_;   // spheres of leaves above the current level
  std::vector<Region> finished_;  // one per node above the current level; only leaves keep theirs
};

}  // namespace

CoveredTree top_down(const MeshView& mesh, const BuildRun& run, const DriverInput& input, Workers& workers) {
  run.throw_if_stopped();
  if (is_worst_first(run)) {
    if (input.distance) return best_first(mesh, run, input.root_cell, input.divide, *input.distance, workers);
    return best_first(mesh, run, input.root_cell, input.divide, SignedDistance(mesh, workers), workers);
  }
  run.tell(0, 0);
  return LevelByLevel(mesh, run, input, workers)();
}

}  // namespace morula::detail
