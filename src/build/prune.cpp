// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "build/prune.hpp"

#include <algorithm>
#include <set>

namespace morula {
namespace {

class Pruner {
 public:
  Pruner(std::vector<Grown>& nodes, const Judge& judge) : nodes_(nodes), judge_(judge), joins_(nodes.size()) {
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
  void look_for_join(std::uint32_t parent) {
    std::vector<const BuildNode*> leaves;
    std::vector<Verdict> verdicts;
    for (const std::uint32_t child : nodes_[parent].children) {
      if (!nodes_[child].children.empty()) continue;
      leaves.push_back(&nodes_[child].node);
      verdicts.push_back(nodes_[child].verdict);
    }
    joins_[parent] = judge_.cheapest_join(leaves, verdicts);
  }

  void enqueue(std::uint32_t parent) {
    if (joins_[parent]) queue_.insert({joins_[parent]->cost, parent});
  }

  void join(std::uint32_t parent) {
    Join join = std::move(*joins_[parent]);
    joins_[parent].reset();
    std::vector<std::uint32_t>& children = nodes_[parent].children;
    std::vector<std::uint32_t> leaves;
    for (const std::uint32_t child : children)
      if (nodes_[child].children.empty()) leaves.push_back(child);
    const std::uint32_t kept = leaves[join.first], gone = leaves[join.second];
    std::erase(children, gone);
    nodes_[gone].node.region = {};
    if (children.size() > 1) {
      nodes_[kept].node = std::move(join.node);
      nodes_[kept].verdict = join.verdict;
      look_for_join(parent);
      enqueue(parent);
      return;
    }
    // The only child left: it stands for its parent, whose own sphere may be the better one.
    children.clear();
    nodes_[kept].node.region = {};
    nodes_[parent].node.region = std::move(join.node.region);
    if (join.verdict.worth < nodes_[parent].verdict.worth) {
      nodes_[parent].node.sphere = join.node.sphere;
      nodes_[parent].verdict = join.verdict;
    }
    const std::uint32_t above = parent_[parent];
    if (above == no_node) return;
    if (joins_[above]) queue_.erase({joins_[above]->cost, above});
    look_for_join(above);
    enqueue(above);
  }

  std::vector<Grown>& nodes_;
  const Judge& judge_;
  std::vector<std::optional<Join>> joins_;  // of each node's children
  std::vector<std::uint32_t> parent_;
  std::set<std::pair<double, std::uint32_t>> queue_;  // the cheapest first
};

}  // namespace

void prune(std::vector<Grown>& nodes, std::size_t most, const Judge& judge, const BuildRun& run, Workers& workers) {
  Pruner(nodes, judge)(most, run, workers);
}

}  // namespace morula
