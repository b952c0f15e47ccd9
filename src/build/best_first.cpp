// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Worst leaf first: the driver for a number of spheres, or a greatest protrusion, instead of a depth.
#include <algorithm>
#include <set>

#include "build/growth.hpp"
#include "build/join.hpp"

namespace morula {
namespace {

struct Grown {
  BuildNode node;
  double bound;  // of its protrusion
  double worth;  // what dividing it promises; the greatest is divided first
  std::vector<std::uint32_t> children;
  std::optional<Division> division;  // worked out ahead
  bool dead_end = false;             // cannot be divided
};

class BestFirst {
 public:
  BestFirst(const Mesh& mesh, const BuildRun& run, const Divider& divide, const SignedDistance& shape, Workers& workers)
      : mesh_(mesh),
        run_(run),
        divide_(divide),
        judge_(mesh, shape, run.max_protrusion),
        workers_(workers),
        too_small_(smallest_radius(mesh)) {}

  Built operator()(const Box& root_cell) {
    run_.tell(0, 0);
    report_ = new_report(mesh_, run_);
    add(root_node(mesh_, run_, root_cell));
    all_patches_ = std::max<std::size_t>(1, nodes_[0].node.region.size());
    told_ = run_.seconds();
    report_.level_seconds.assign(1, told_);
    while (!waiting_.empty() && !full()) {
      const std::uint32_t worst = waiting_.begin()->second;
      if (!nodes_[worst].division && !divide_ahead()) break;
      waiting_.erase(waiting_.begin());
      divide_leaf(worst);
    }
    return finish();
  }

 private:
  bool full() const { return run_.spheres > 0 && leaves_ >= run_.spheres; }

  void add(BuildNode node) {
    const double bound = judge_.bound(node.sphere);
    const double worth = judge_.worth(node.sphere);
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    const bool good_enough = run_.max_protrusion > 0 && bound <= run_.max_protrusion;
    if (good_enough) patches_done_ += node.region.size();
    if (!good_enough && node.level < max_depth) waiting_.insert({-worth, index});
    nodes_.push_back({std::move(node), bound, worth, {}, {}, false});
  }

  // Works out the divisions of the worst leaves that have none yet, several at a time. They are used strictly in order,
  // so what is worked out ahead changes nothing; a few at the end are for nothing.
  bool divide_ahead() {
    std::size_t most = std::max<std::size_t>(16, 8 * std::size_t{workers_.thread_count()});
    if (run_.spheres > 0) {
      const std::size_t gain = std::max<std::size_t>(1, static_cast<std::size_t>(run_.branching) - 1);
      most = std::min(most, (run_.spheres - leaves_ + gain - 1) / gain);
    }
    std::vector<std::uint32_t> chosen;
    for (auto at = waiting_.begin(); at != waiting_.end() && chosen.size() < most; ++at)
      if (!nodes_[at->second].division) chosen.push_back(at->second);
    std::vector<std::optional<Division>> divisions(chosen.size());
    workers_.run(chosen.size(), [&](std::size_t i) {
      if (run_.stop.stop_requested() || run_.out_of_time()) return;
      divisions[i] = children_of(nodes_[chosen[i]].node, divide_, too_small_);
      if (run_.max_protrusion > 0) judge_.join_while_good(*divisions[i]);
    });
    run_.throw_if_stopped();
    double levels = 0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (!divisions[i]) continue;
      nodes_[chosen[i]].division = std::move(divisions[i]);
      ++levels;
    }
    // A batch's time is shared among the levels that it made nodes for.
    const double now = run_.seconds();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const auto level = static_cast<std::size_t>(nodes_[chosen[i]].node.level) + 1;
      if (!nodes_[chosen[i]].division) continue;
      if (report_.level_seconds.size() <= level) report_.level_seconds.resize(level + 1);
      report_.level_seconds[level] += (now - told_) / levels;
    }
    told_ = now;
    tell();
    run_.throw_if_stopped();
    out_of_time_ = levels < static_cast<double>(chosen.size());
    return nodes_[chosen[0]].division.has_value();
  }

  void tell() const {
    double share = 0;
    if (run_.spheres > 0) share = static_cast<double>(leaves_) / static_cast<double>(run_.spheres);
    if (run_.max_protrusion > 0)
      share = std::max(share, static_cast<double>(patches_done_) / static_cast<double>(all_patches_));
    std::optional<double> left;
    if (share > 0.02) left = run_.seconds() * std::max(0.0, 1 - share) / share;
    run_.tell(std::min(share, 1.0), deepest_ + 1, left);
  }

  void divide_leaf(std::uint32_t leaf) {
    Division division = std::move(*nodes_[leaf].division);
    nodes_[leaf].division.reset();
    if (division.children.empty()) {
      nodes_[leaf].dead_end = true;
      return;
    }
    if (run_.spheres > 0) judge_.join_to(division, run_.spheres - leaves_ + 1);
    report_.leftover_patches += division.leftover_patches;
    winners_.add(division);
    deepest_ = std::max(deepest_, nodes_[leaf].node.level + 1);
    leaves_ += division.children.size() - 1;
    for (BuildNode& child : division.children) {
      nodes_[leaf].children.push_back(static_cast<std::uint32_t>(nodes_.size()));
      add(std::move(child));
    }
    nodes_[leaf].node.region = {};
  }

  // The tree, level by level.
  Built finish() {
    run_.throw_if_stopped();
    Built built;
    built.tree.branching = report_.branching;
    std::vector<Region> regions;
    std::vector<std::uint32_t> level{0};
    built.tree.append_level({}, std::span(&nodes_[0].node.sphere, 1));
    double worst = 0;
    while (!level.empty()) {
      std::vector<std::uint32_t> counts, next;
      std::vector<Sphere> spheres;
      for (const std::uint32_t i : level) {
        Grown& grown = nodes_[i];
        counts.push_back(static_cast<std::uint32_t>(grown.children.size()));
        regions.push_back(std::move(grown.node.region));
        if (grown.children.empty()) worst = std::max(worst, grown.bound);
        for (const std::uint32_t child : grown.children) {
          next.push_back(child);
          spheres.push_back(nodes_[child].node.sphere);
        }
      }
      if (!next.empty()) built.tree.append_level(counts, spheres);
      level = std::move(next);
    }
    built.cover = assemble_cover(mesh_, built.tree, regions);
    report_.depth = static_cast<std::uint32_t>(built.tree.level_count() - 1);
    report_.level_seconds.resize(built.tree.level_count());
    for (std::uint32_t i = 0; i < built.tree.level_begin[built.tree.level_count() - 1]; ++i)
      report_.early_leaves += built.tree.is_leaf(i);
    report_.protrusion_bound = worst;
    write_notes(worst);
    if (std::string note = winners_.note(); !note.empty()) report_.notes.push_back(std::move(note));
    built.report = std::move(report_);
    run_.tell(1, deepest_, 0.0);
    run_.throw_if_stopped();
    return built;
  }

  void write_notes(double worst) {
    if (out_of_time_) {
      report_.complete = false;
      report_.notes.push_back("the time limit of " + short_number(run_.time_limit_seconds) + " s was over at " +
                              std::to_string(leaves_) + " spheres: " + std::to_string(waiting_.size()) +
                              " of them were left undivided, down to level " + std::to_string(deepest_));
    }
    const bool stick_out = run_.max_protrusion > 0 && worst > run_.max_protrusion;
    if (stick_out) report_.complete = false;
    if (out_of_time_ || (full() && !stick_out) || (run_.spheres == 0 && !stick_out)) return;
    std::size_t dead_ends = 0, lowest = 0, others = 0;
    for (const Grown& grown : nodes_) {
      if (!grown.children.empty() || (stick_out && grown.bound <= run_.max_protrusion)) continue;
      if (grown.dead_end)
        ++dead_ends;
      else if (grown.node.level >= max_depth)
        ++lowest;
      else
        ++others;
    }
    if (stick_out) {
      std::string note = std::to_string(dead_ends + lowest + others) + " spheres stick out by more than " +
                         short_number(run_.max_protrusion) + ", at most " + short_number(worst) + ":";
      if (dead_ends > 0) note += " " + std::to_string(dead_ends) + " cannot be divided further;";
      if (lowest > 0) note += " " + std::to_string(lowest) + " are on level 8, the last;";
      if (others > 0) note += " more than " + std::to_string(run_.spheres) + " spheres are needed;";
      note.pop_back();
      report_.notes.push_back(std::move(note));
    } else if (run_.max_protrusion == 0) {
      report_.notes.push_back(std::to_string(leaves_) + " spheres, not " + std::to_string(run_.spheres) + ": " +
                              std::to_string(dead_ends) + " cannot be divided further, " + std::to_string(lowest) +
                              " are on level 8, the last");
    }
  }

  const Mesh& mesh_;
  const BuildRun& run_;
  const Divider& divide_;
  const Judge judge_;
  Workers& workers_;
  double too_small_;
  BuildReport report_;
  Winners winners_;
  std::vector<Grown> nodes_;                            // numbered in the order they were made
  std::set<std::pair<double, std::uint32_t>> waiting_;  // leaves still to be divided, worst first, then oldest
  std::size_t leaves_ = 1, patches_done_ = 0, all_patches_ = 1;
  int deepest_ = 0;
  double told_ = 0;
  bool out_of_time_ = false;
};

}  // namespace

Built best_first(const Mesh& mesh, const BuildRun& run, const Box& root_cell, const Divider& divide,
                 const SignedDistance& shape, Workers& workers) {
  return BestFirst(mesh, run, divide, shape, workers)(root_cell);
}

}  // namespace morula
