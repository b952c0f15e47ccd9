// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_training.hpp"

#include <algorithm>
#include <cassert>
#include <queue>
#include <stdexcept>
#include <string>
#include <vector>

#include "parallel/interruption.hpp"
#include "update/points/facet_hull.hpp"
#include "update/points/ownership_check.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula::detail {
namespace {

// Times of an influence of a vertex that moves, and of a node's center, over that of a point that is tested.
constexpr double cost_of_influence = 4, cost_of_node = 64;
// Nodes that gain less on average are not measured: spheres grow by as much by rounding and by centers.
constexpr double least_gain_of_training = 0.01;
// Largest gain at one pose: a measured sphere may have no volume.
constexpr double most_gain = 1000;

using Transforms = std::span<const AffineTransform>;

void require_training(const Binding& binding) {
  const std::vector<AffineTransform>& training = binding.options.training;
  const std::size_t bones = binding.options.skin.bone_count;
  if (training.empty()) throw std::invalid_argument("skinned_measured above 0 needs poses (UpdateOptions::training)");
  if (training.size() % bones != 0)
    throw std::invalid_argument("the training has " + std::to_string(training.size()) +
                                " transforms, which is no multiple of the skin's " + std::to_string(bones) + " bones");
  const SkinPoser& poser = *binding.posers.skin;
  for (std::size_t first = 0; first < training.size(); first += bones)
    if (std::size_t bad = 0; !poser.accepts(Transforms(training).subspan(first, bones), poser.unmorphed(), bad))
      throw std::invalid_argument("frame " + std::to_string(first / bones) + " of the training moves bone " +
                                  std::to_string(bad) + " too far, or its transform is not finite");
}

double gain(const Spheref& by_bones, const Spheref& measured) {
  const double ratio = static_cast<double>(by_bones.radius) / static_cast<double>(measured.radius);
  return std::min(ratio * ratio * ratio - 1, most_gain);
}

// The mean gain of each node of the tree.
std::vector<double> mean_gains(const Binding& binding, const SpheresByBones& by_bones, MeasuredNodes& all) {
  const Transforms training = binding.options.training;
  const std::size_t bones = binding.options.skin.bone_count, frames = training.size() / bones;
  std::vector<double> gains(binding.spheres.size());
  std::vector<Spheref> bound(binding.spheres.size()), measured;
  for (std::size_t f = 0; f < frames; ++f) {
    check_interrupt();
    const BonePose pose = binding.posers.skin->pose(binding.options.skin, training.subspan(f * bones, bones));
    const RuleFrame frame{.origin = pose.origin, .bones = &pose};
    by_bones(frame, bound);
    measured = bound;
    all.measure(frame, measured.size(), measured, binding.workers);
    for (const std::uint32_t node : all.nodes())
      gains[node] += gain(bound[node], measured[node]) / static_cast<double>(frames);
  }
  return gains;
}

// Vertices that leaves of the order depend on, with their influences as cost.
class LeafVertices {
 public:
  explicit LeafVertices(const Binding& binding) : leaves_of_(binding.mesh.vertex_count()) {
    const Cover& cover = binding.model.cover;
    for (std::uint32_t k = 0; k < binding.order.leaves.size(); ++k) {
      const std::uint32_t leaf = binding.order.leaves[k];
      std::vector<std::uint32_t>& vertices = of_leaf_.emplace_back();
      for (std::uint32_t patch = cover.region_begin[leaf]; patch < cover.region_end[leaf]; ++patch)
        for (const std::uint32_t v : binding.mesh.facets[cover.patch_facet[patch]])
          if (leaves_of_[v].empty() || leaves_of_[v].back() != k) leaves_of_[v].push_back(k), vertices.push_back(v);
    }
  }
  std::span<const std::uint32_t> of_leaf(std::uint32_t k) const { return of_leaf_[k]; }
  std::span<const std::uint32_t> leaves_of(std::uint32_t vertex) const { return leaves_of_[vertex]; }

 private:
  std::vector<std::vector<std::uint32_t>> of_leaf_, leaves_of_;
};

// Takes nodes by gain over cost. A vertex that a taken node needs costs the others nothing.
class Selection {
 public:
  Selection(const Binding& binding, const MeasuredNodes& all, std::span<const double> gains)
      : binding_(binding),
        vertices_(binding),
        gains_(gains),
        own_cost_(gains.size()),
        vertex_cost_(gains.size()),
        taken_(gains.size()),
        touched_(gains.size()),
        moves_(binding.mesh.vertex_count()) {
    for (const std::uint32_t node : all.nodes())
      total_ += own_cost_[node] = cost_of_node + static_cast<double>(all.points_of(node));
    for (std::uint32_t v = 0; v < moves_.size(); ++v) {
      bool is_needed = false;
      each_node_with(v, [&](std::uint32_t node) {
        vertex_cost_[node] += cost_of(v);
        is_needed = is_needed || own_cost_[node] > 0;  // not for nodes of other rules
      });
      if (is_needed) total_ += cost_of(v);
    }
    for (const std::uint32_t node : all.nodes()) push(node);
  }

  // One flag per node of the tree. budget: a share of the cost of all.
  const std::vector<std::uint8_t>& take_within(double budget) {
    double left = budget * total_ * (1 + 0x1p-40);  // all fit into a budget of 1
    while (!queue_.empty()) {
      const auto [worth, node] = queue_.top();
      queue_.pop();
      const double cost = cost_of_taking(node);
      // mutant measured-beyond-budget: `cost > left` -> `false`
      if (taken_[node] != 0 || worth != gains_[node] / cost || cost > left) continue;
      left -= cost;
      take(node);
    }
    return taken_;
  }

 private:
  struct Candidate {
    double worth;
    std::uint32_t node;
    bool operator<(const Candidate& other) const {
      return worth != other.worth ? worth < other.worth : node > other.node;
    }
  };

  double cost_of(std::uint32_t vertex) const {
    const std::vector<std::uint32_t>& begin = binding_.options.skin.begin;
    return cost_of_influence * (1 + begin[vertex + 1] - begin[vertex]);
  }
  double cost_of_taking(std::uint32_t node) const { return own_cost_[node] + vertex_cost_[node]; }
  // Costs fall, so the last entry of a node is its first in the queue.
  void push(std::uint32_t node) {
    if (gains_[node] >= least_gain_of_training) queue_.push({gains_[node] / cost_of_taking(node), node});
  }

  // Calls visit(node) for each node of the tree that depends on the vertex.
  template <class Visit>
  void each_node_with(std::uint32_t vertex, const Visit& visit) {
    ++stamp_;
    for (const std::uint32_t leaf : vertices_.leaves_of(vertex))
      for (std::uint32_t node = binding_.order.leaves[leaf]; node != no_node && touched_[node] != stamp_;
           node = binding_.model.tree.parent[node])
        touched_[node] = stamp_, visit(node);
  }

  void take(std::uint32_t taken) {
    taken_[taken] = 1;
    changed_.clear();
    for (std::uint32_t k = binding_.order.begin[taken]; k < binding_.order.end[taken]; ++k)
      for (const std::uint32_t v : vertices_.of_leaf(k)) {
        if (moves_[v] != 0) continue;
        moves_[v] = 1;
        each_node_with(v, [&](std::uint32_t node) { vertex_cost_[node] -= cost_of(v), changed_.push_back(node); });
      }
    std::sort(changed_.begin(), changed_.end());
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const std::uint32_t node : changed_)
      if (taken_[node] == 0) push(node);
  }

  const Binding& binding_;
  LeafVertices vertices_;
  std::span<const double> gains_;
  std::vector<double> own_cost_, vertex_cost_;  // costs of each node: its own, and its untaken vertices
  std::vector<std::uint8_t> taken_;
  std::vector<std::uint32_t> touched_;
  std::vector<std::uint8_t> moves_;  // flags of the mesh's vertices
  std::vector<std::uint32_t> changed_;
  std::priority_queue<Candidate> queue_;
  double total_ = 0;
  std::uint32_t stamp_ = 0;
};

}  // namespace

std::optional<MeasuredNodes> trained_nodes(const Binding& binding, const SpheresByBones& by_bones) {
  const double budget = binding.options.details.skinned_measured;
  if (!(budget > 0)) return std::nullopt;
  require_training(binding);
  const CoveredTree& model = binding.model;
  const std::vector<std::uint8_t> every_leaf(binding.order.leaves.size(), 1);
  Ownership ownership = share_points(binding.mesh, model.cover, binding.order, every_leaf, hull_tolerance);
  share_levels(binding.mesh, model.tree, model.cover, binding.order, hull_tolerance, ownership);
  assert(ownership_faults(binding.mesh, model.tree, model.cover, binding.order, ownership, every_leaf, hull_tolerance)
             .empty());
  std::vector<std::uint8_t> follows_bones;
  for (const Rule rule : binding.rules.of_node) follows_bones.push_back(rule == Rule::skinned ? 1 : 0);
  MeasuredNodes all(binding, ownership, follows_bones);
  const std::vector<double> gains = mean_gains(binding, by_bones, all);
  const std::vector<std::uint8_t> taken = Selection(binding, all, gains).take_within(budget);
  binding.report.nodes_measured = static_cast<std::size_t>(std::count(taken.begin(), taken.end(), 1));
  if (binding.report.nodes_measured == 0) return std::nullopt;
  return MeasuredNodes(binding, ownership, taken);
}

}  // namespace morula::detail
