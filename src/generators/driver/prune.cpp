// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/driver/prune.hpp"

#include <algorithm>
#include <map>
#include <set>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

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
    ask_to_go_on();
    Candidates& of = candidates_[parent];
    std::vector<std::pair<double, Pair>> pairs;
    const std::vector<std::uint32_t>& children = nodes_[parent].children;
    for (std::size_t i = 0; i < children.size(); ++i)
      for (std::size_t j = i + 1; j < children.size(); ++j)
        if (nodes_[children[i]].children.empty() && nodes_[children[j]].children.empty())
          pairs.push_back({common_radius(nodes_[children[i]].node.sphere, nodes_[children[j]].node.sphere),
                           {children[i], children[j]}});
    // Fitting is what costs: only the closest pairs are tried, and what was tried before is remembered.
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
    // The only child left: it stands for its parent, whose own sphere may be the better one.
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
  std::vector<Candidates> candidates_;  // of each node
  std::vector<std::uint32_t> parent_;
  std::set<std::pair<double, std::uint32_t>> queue_;  // the cheapest first
};

}  // namespace

void prune(std::vector<Grown>& nodes, std::size_t most, const LeafScore& score, const BuildRun& run, Workers& workers) {
  Pruner(nodes, score)(most, run, workers);
}

}  // namespace morula::detail
