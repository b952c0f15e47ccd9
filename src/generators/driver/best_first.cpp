// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Worst leaf first: the driver for a number of spheres, or a greatest protrusion, instead of a depth.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "generators/driver/driver.hpp"
#include "generators/driver/join.hpp"
#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

// A division computed ahead, with the scores of its children.
struct Prepared {
  Division division;
  std::vector<Verdict> verdicts;
};

struct Grown {
  BuildNode node;  // only leaves keep their region
  Verdict verdict;
  std::vector<std::uint32_t> children{};
  std::optional<Prepared> prepared{};
  bool dead_end = false;  // the node cannot be divided
};

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // two leaves, the children of one node
struct Candidates {
  std::map<Pair, Join> joins;
  std::optional<Pair> best;
};

class Pruner {
 public:
  Pruner(std::vector<Grown>& nodes, const LeafScore& score) : nodes_(nodes), score_(score), candidates_(nodes.size()) {
    parent_.resize(nodes.size(), no_node);
    for (std::uint32_t i = 0; i < nodes.size(); ++i)
      for (const std::uint32_t child : nodes[i].children) parent_[child] = i;
  }

  std::size_t leaf_count() const {
    std::size_t count = 0;
    const auto visit = [&](const auto& self, std::uint32_t node) -> void {
      count += nodes_[node].children.empty();
      for (const std::uint32_t child : nodes_[node].children) self(self, child);
    };
    visit(visit, 0);
    return count;
  }

  void operator()(std::size_t most, const BuildRun& run, Workers& workers) {
    std::vector<std::uint32_t> parents;
    for (std::uint32_t i = 0; i < nodes_.size(); ++i)
      if (!nodes_[i].children.empty()) parents.push_back(i);
    workers.run(parents.size(), [&](std::size_t i) {
      if (!run.stop.stop_requested()) look_for_join(parents[i]);
    });
    run.throw_if_stopped();
    for (const std::uint32_t p : parents) enqueue(p);
    for (std::size_t leaves = leaf_count(); leaves > most && !queue_.empty(); --leaves) {
      const std::uint32_t parent = queue_.begin()->second;
      queue_.erase(queue_.begin());
      join(parent);
      run.throw_if_stopped();
    }
  }

 private:
  // The least cost of joining two leaves among a node's children.
  void look_for_join(std::uint32_t parent) {
    check_interrupt();
    Candidates& of = candidates_[parent];
    std::vector<std::pair<double, Pair>> pairs;
    const std::vector<std::uint32_t>& children = nodes_[parent].children;
    for (std::size_t i = 0; i < children.size(); ++i)
      for (std::size_t j = i + 1; j < children.size(); ++j)
        if (nodes_[children[i]].children.empty() && nodes_[children[j]].children.empty())
          pairs.push_back({common_radius(nodes_[children[i]].node.sphere, nodes_[children[j]].node.sphere),
                           {children[i], children[j]}});
    // Fits dominate the cost: only the closest pairs are tried, and tried pairs are remembered.
    constexpr std::size_t most_trials = 8;
    const std::size_t trials = std::min(most_trials, pairs.size());
    std::partial_sort(pairs.begin(), pairs.begin() + static_cast<std::ptrdiff_t>(trials), pairs.end());
    of.best.reset();
    for (std::size_t k = 0; k < trials; ++k) {
      const Pair pair = pairs[k].second;
      const Grown &a = nodes_[pair.first], &b = nodes_[pair.second];
      auto known = of.joins.find(pair);
      if (known == of.joins.end())
        known = of.joins.emplace(pair, score_.join(a.node, a.verdict, b.node, b.verdict)).first;
      if (!of.best || known->second.cost < of.joins.at(*of.best).cost) of.best = pair;
    }
  }
  double cost(std::uint32_t parent) const { return candidates_[parent].joins.at(*candidates_[parent].best).cost; }

  void enqueue(std::uint32_t parent) {
    if (candidates_[parent].best) queue_.insert({cost(parent), parent});
  }

  void join(std::uint32_t parent) {
    Candidates& of = candidates_[parent];
    const auto [kept, gone] = *of.best;
    const Join join = of.joins.at(*of.best);
    std::erase_if(of.joins, [kept = kept, gone = gone](const auto& entry) {
      const Pair& pair = entry.first;
      return pair.first == kept || pair.first == gone || pair.second == kept || pair.second == gone;
    });
    BuildNode node = joined(nodes_[kept].node, nodes_[gone].node, join.sphere);
    nodes_[gone].node.region = {};
    std::vector<std::uint32_t>& children = nodes_[parent].children;
    std::erase(children, gone);
    if (children.size() > 1) {
      nodes_[kept].node = std::move(node);
      nodes_[kept].verdict = join.verdict;
      look_for_join(parent);
      enqueue(parent);
      return;
    }
    // The only child left: it replaces its parent, whose own sphere may be the better one.
    children.clear();
    nodes_[kept].node.region = {};
    nodes_[parent].node.region = std::move(node.region);
    if (join.verdict.gain < nodes_[parent].verdict.gain) {
      nodes_[parent].node.sphere = join.sphere;
      nodes_[parent].verdict = join.verdict;
    }
    const std::uint32_t above = parent_[parent];
    if (above == no_node) return;
    if (candidates_[above].best) queue_.erase({cost(above), above});
    look_for_join(above);
    enqueue(above);
  }

  std::vector<Grown>& nodes_;
  const LeafScore& score_;
  std::vector<Candidates> candidates_;  // candidates of each node
  std::vector<std::uint32_t> parent_;
  std::set<std::pair<double, std::uint32_t>> queue_;  // the cheapest first
};

// Joins two sibling leaves after the other, cheapest first, until at most `most` leaves are left; a node whose children
// have become one is that leaf. nodes: the root first. Joined nodes leave their parent's list of children.
void prune(std::vector<Grown>& nodes, std::size_t most, const LeafScore& score, const BuildRun& run, Workers& workers) {
  Pruner(nodes, score)(most, run, workers);
}

// Leaves are grown to so many times the requested number of spheres, then pruned: only more spheres show where
// divisions gain most. The cost is that share more time.
constexpr double overshoot = 2;

class BestFirst {
 public:
  BestFirst(const MeshView& mesh, const BuildRun& run, const Divider& divide, const SignedDistance& shape,
            Workers& workers)
      : mesh_(mesh),
        run_(run),
        divide_(divide),
        score_(mesh, shape, run),
        workers_(workers),
        too_small_(smallest_radius(run)),
        wanted_(leaves_wanted(run)) {}

  CoveredTree operator()(const Box& root_cell) {
    run_.tell(0, 0);
    report_ = new_report(mesh_, run_);
    BuildNode root = root_node(mesh_, run_, root_cell);
    const Verdict verdict = score_(root.sphere);
    add(std::move(root), verdict);
    all_patches_ = std::max<std::size_t>(1, nodes_[0].node.region.size());
    last_report_ = run_.seconds();
    report_.level_seconds.assign(1, last_report_);
    while (!waiting_.empty() && !full()) {
      const std::uint32_t worst = waiting_.begin()->second;
      if (!nodes_[worst].prepared && !divide_ahead()) break;
      waiting_.erase(waiting_.begin());
      divide_leaf(worst);
    }
    grown_ = leaves_;
    if (run_.spheres > 0 && leaves_ > run_.spheres) {
      prune(nodes_, run_.spheres, score_, run_, workers_);
      leaves_ = run_.spheres;
    }
    return finish();
  }

 private:
  // Number of leaves that are grown before any is joined to others.
  static std::size_t leaves_wanted(const BuildRun& run) {
    if (run.spheres == 0) return std::numeric_limits<std::size_t>::max();
    if (run.spheres == 1 || run.max_protrusion > 0) return run.spheres;
    return static_cast<std::size_t>(std::ceil(overshoot * static_cast<double>(run.spheres)));
  }
  bool full() const { return leaves_ >= wanted_; }

  void add(BuildNode node, const Verdict& verdict) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    const bool good_enough = run_.max_protrusion > 0 && verdict.bound <= run_.max_protrusion;
    if (good_enough) patches_done_ += node.region.size();
    if (!good_enough && node.level < max_depth) waiting_.insert({-verdict.gain, index});
    nodes_.push_back({std::move(node), verdict});
  }

  // Computes the divisions of the worst leaves that have none yet, several at a time. They are used strictly in order,
  // so computing ahead changes no result; a few at the end are unused.
  bool divide_ahead() {
    std::size_t most = std::max<std::size_t>(16, 8 * std::size_t{workers_.thread_count()});
    if (run_.spheres > 0) {
      const std::size_t gain = std::max<std::size_t>(1, static_cast<std::size_t>(run_.branching) - 1);
      most = std::min(most, (wanted_ - leaves_ + gain - 1) / gain);
    }
    std::vector<std::uint32_t> chosen;
    for (auto at = waiting_.begin(); at != waiting_.end() && chosen.size() < most; ++at)
      if (!nodes_[at->second].prepared) chosen.push_back(at->second);
    std::vector<std::optional<Prepared>> prepared(chosen.size());
    workers_.run(chosen.size(), [&](std::size_t i) {
      if (run_.stop.stop_requested() || run_.out_of_time()) return;
      prepared[i].emplace();
      Division& division = prepared[i]->division = children_of(nodes_[chosen[i]].node, divide_, too_small_);
      if (run_.max_protrusion > 0) score_.make_few(division);
      prepared[i]->verdicts = verdicts(division);
    });
    run_.throw_if_stopped();
    double levels = 0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (!prepared[i]) continue;
      nodes_[chosen[i]].prepared = std::move(prepared[i]);
      ++levels;
    }
    // A batch's time is shared among the levels that it made nodes for.
    const double now = run_.seconds();
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const auto level = static_cast<std::size_t>(nodes_[chosen[i]].node.level) + 1;
      if (!nodes_[chosen[i]].prepared) continue;
      if (report_.level_seconds.size() <= level) report_.level_seconds.resize(level + 1);
      report_.level_seconds[level] += (now - last_report_) / levels;
    }
    last_report_ = now;
    tell();
    run_.throw_if_stopped();
    out_of_time_ = levels < static_cast<double>(chosen.size());
    return nodes_[chosen[0]].prepared.has_value();
  }

  std::vector<Verdict> verdicts(const Division& division) const {
    std::vector<Verdict> all;
    for (const BuildNode& child : division.children) all.push_back(score_(child.sphere));
    return all;
  }

  void tell() const {
    double share = 0;
    if (run_.spheres > 0) share = static_cast<double>(leaves_) / static_cast<double>(wanted_);
    if (run_.max_protrusion > 0)
      share = std::max(share, static_cast<double>(patches_done_) / static_cast<double>(all_patches_));
    std::optional<double> left;
    if (share > 0.02) left = run_.seconds() * std::max(0.0, 1 - share) / share;
    run_.tell(std::min(share, 1.0), std::min(deepest_ + 1, max_depth), left);
  }

  void divide_leaf(std::uint32_t leaf) {
    auto [division, judged] = std::move(*nodes_[leaf].prepared);
    nodes_[leaf].prepared.reset();
    if (division.children.empty()) {
      nodes_[leaf].dead_end = true;
      return;
    }
    report_.leftover_patches += division.leftover_patches;
    winners_.add(division);
    deepest_ = std::max(deepest_, nodes_[leaf].node.level + 1);
    leaves_ += division.children.size() - 1;
    for (std::size_t i = 0; i < judged.size(); ++i) {
      nodes_[leaf].children.push_back(static_cast<std::uint32_t>(nodes_.size()));
      add(std::move(division.children[i]), judged[i]);
    }
    nodes_[leaf].node.region = {};
  }

  // The tree, level by level.
  CoveredTree finish() {
    run_.throw_if_stopped();
    CoveredTree model;
    model.tree.branching = report_.branching;
    std::vector<Region> regions;
    std::vector<std::uint32_t> level{0};
    model.tree.append_level({}, std::span(&nodes_[0].node.sphere, 1));
    std::vector<std::uint32_t> leaves;
    double worst = 0;
    while (!level.empty()) {
      std::vector<std::uint32_t> counts, next;
      std::vector<Sphere> spheres;
      for (const std::uint32_t i : level) {
        Grown& grown = nodes_[i];
        counts.push_back(static_cast<std::uint32_t>(grown.children.size()));
        regions.push_back(std::move(grown.node.region));
        if (grown.children.empty()) {
          leaves.push_back(i);
          worst = std::max(worst, grown.verdict.bound);
        }
        for (const std::uint32_t child : grown.children) {
          next.push_back(child);
          spheres.push_back(nodes_[child].node.sphere);
        }
      }
      if (!next.empty()) model.tree.append_level(counts, spheres);
      level = std::move(next);
    }
    model.cover = assemble_cover(mesh_, model.tree, std::move(regions));
    report_.depth = static_cast<std::uint32_t>(model.tree.level_count() - 1);
    report_.level_seconds.resize(model.tree.level_count());
    for (std::uint32_t i = 0; i < model.tree.level_begin[model.tree.level_count() - 1]; ++i)
      report_.early_leaves += model.tree.is_leaf(i);
    report_.protrusion_bound = std::max(0.0, worst - run_.tolerance);
    write_notes(leaves);
    if (std::string note = winners_.note(); !note.empty()) report_.notes.push_back(std::move(note));
    model.report = std::move(report_);
    run_.tell(1, deepest_, 0.0);
    run_.throw_if_stopped();
    return model;
  }

  /// The limit that ended the division, if both were given.
  std::string which_limit(std::size_t sticking_out) const {
    const std::string length = short_number(run_.max_protrusion - run_.tolerance), most = std::to_string(run_.spheres);
    if (sticking_out == 0)
      return "the protrusion ended it: with " + std::to_string(leaves_) + " of at most " + most +
             " spheres none sticks out by more than " + length;
    if (leaves_ >= run_.spheres)
      return "the number of spheres ended it: all " + most + " are used, and some stick out by more than " + length;
    return "neither limit ended it: no sphere that sticks out by more than " + length +
           " can be divided further within " + most + " spheres";
  }

  void write_notes(const std::vector<std::uint32_t>& leaves) {
    std::size_t dead_ends = 0, lowest = 0, others = 0, sticking_out = 0;
    for (const std::uint32_t i : leaves) {
      const Grown& leaf = nodes_[i];
      sticking_out += leaf.verdict.bound > run_.max_protrusion;
      if (leaf.verdict.bound <= run_.max_protrusion) continue;
      (leaf.dead_end ? dead_ends : leaf.node.level >= max_depth ? lowest : others) += 1;
    }
    const std::string ends = std::to_string(dead_ends) + " cannot be divided further, " + std::to_string(lowest) +
                             " are on level " + std::to_string(max_depth) + ", the last";
    if (out_of_time_) {
      report_.complete = false;
      report_.notes.push_back("the time limit of " + short_number(*run_.time_limit_seconds) + " s was over at " +
                              std::to_string(grown_) + " spheres, " + std::to_string(waiting_.size()) +
                              " of them undivided, on levels up to " + std::to_string(deepest_));
    }
    if (run_.max_protrusion > 0 && run_.spheres > 0 && !out_of_time_)
      report_.notes.push_back(which_limit(sticking_out));
    if (run_.max_protrusion > 0 && sticking_out > 0) {
      report_.complete = false;
      std::string note = std::to_string(sticking_out) + " spheres stick out by more than " +
                         short_number(run_.max_protrusion - run_.tolerance) + ", by " +
                         short_number(*report_.protrusion_bound) + " at most: " + ends;
      if (others > 0) note += ", " + std::to_string(others) + " were not divided for want of spheres or time";
      report_.notes.push_back(std::move(note));
    } else if (run_.max_protrusion == 0 && leaves_ < run_.spheres && !out_of_time_) {
      report_.notes.push_back(std::to_string(leaves_) + " spheres, not " + std::to_string(run_.spheres) + ": " + ends);
    }
  }

  MeshView mesh_;
  const BuildRun& run_;
  const Divider& divide_;
  const LeafScore score_;
  Workers& workers_;
  double too_small_;
  std::size_t wanted_;
  BuildReport report_;
  Winners winners_;
  std::vector<Grown> nodes_;                            // numbered in the order they were made
  std::set<std::pair<double, std::uint32_t>> waiting_;  // leaves still to be divided, worst first, then oldest
  std::size_t leaves_ = 1, grown_ = 1, patches_done_ = 0, all_patches_ = 1;
  int deepest_ = 0;
  double last_report_ = 0;
  bool out_of_time_ = false;
};

}  // namespace

CoveredTree best_first(const MeshView& mesh, const BuildRun& run, const Box& root_cell, const Divider& divide,
                       const SignedDistance& shape, Workers& workers) {
  return BestFirst(mesh, run, divide, shape, workers)(root_cell);
}

}  // namespace morula::detail
