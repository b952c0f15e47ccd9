// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/sphere.hpp>
#include <morula/tree/sphere_tree.hpp>
#include <span>
#include <vector>

#include "parallel/interruption.hpp"
#include "update/points/kernels.hpp"
#include "update/points/local_points.hpp"
#include "update/points/marks.hpp"
#include "update/points/outermost.hpp"
#include "update/points/ownership.hpp"
#include "update/rules/engine_table.hpp"

namespace morula::detail {

namespace {

constexpr std::size_t bounds_per_chunk = 4 * nodes_at_once;
// Limit, in radii, of points that may become the nearest to a leaf's center.
constexpr float farthest_near = 2;
// A leaf whose cost is at most this times its cost at the tree's own pose is good: a rigid motion changes no cost by
// more than rounding does, and the center that a builder chose stays.
// mutant fit-kept-at-rest: `1.05f` -> `0.5f`
// mutant fit-of-rigid-motions: `1.05f` -> `1`
constexpr float most_costly = 1.05f;

Vec3f at(const LocalPoint& p) {
  return {p.x, p.y, p.z};
}

}  // namespace

// The points nearest to a center on all sides of it are the outermost ones under the inversion about it: y = x / |x|²
// maps a sphere through the center to a plane, so the farthest y along a direction is the x that a sphere which grows
// from the center that way meets first.
LeafFits::LeafFits(std::span<const std::uint32_t> nodes, std::span<const std::uint32_t> cores,
                   std::span<const LocalPoint> points, std::span<const Spheref> spheres, Workers& workers)
    : nodes_(nodes.begin(), nodes.end()) {
  const std::size_t leaf_count = nodes.size();
  const std::size_t padded = (leaf_count + nodes_at_once - 1) / nodes_at_once * nodes_at_once;
  cores_.resize(padded * core_size), near_.resize(padded * near_size);
  enough_.resize(padded, std::numeric_limits<float>::infinity());
  parallel_for(workers, leaf_count, bounds_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::vector<LocalPoint> inverted;
    std::vector<std::uint32_t> around, listed;
    std::array<std::uint32_t, near_size> near;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      const std::span<const std::uint32_t> core = cores.subspan(core_size * leaf, core_size);
      const Spheref& sphere = spheres[nodes[leaf]];
      inverted.clear(), around.clear(), listed.clear();
      for (std::uint32_t p = 0; p < points.size(); ++p) {
        const Vec3f out = at(points[p]) - sphere.center;
        const float squared = squared_length(out), limit = farthest_near * sphere.radius;
        if (!(squared > 0) || squared > limit * limit) continue;
        const Vec3f y = out * (1 / squared);
        listed.push_back(static_cast<std::uint32_t>(inverted.size()));
        inverted.push_back({y.x, y.y, y.z, 0});
        around.push_back(p);
      }
      if (around.empty()) {
        near.fill(core.front());
      } else {
        outermost(inverted, listed, {}, near);
        for (std::uint32_t& p : near) p = around[p];
      }
      float most = 0, nearest = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < core_size; ++i) {
        cores_[place(leaf, i, core_size)] = core[i];
        most = std::max(most, squared_length(at(points[core[i]]) - sphere.center));
      }
      for (std::size_t i = 0; i < near_size; ++i) {
        near_[place(leaf, i, near_size)] = near[i];
        nearest = std::min(nearest, squared_length(at(points[near[i]]) - sphere.center));
      }
      enough_[leaf] = std::max(0.0f, most_costly * (most - nearest));
    }
  });
}

void LeafFits::move(std::span<const LocalPoint> points, std::span<Spheref> spheres, Workers& workers) const noexcept {
  static_assert(bounds_per_chunk % nodes_at_once == 0);
  const Uninterrupted whole;
  parallel_for(workers, nodes_.size(), bounds_per_chunk, [&](std::size_t begin, std::size_t end) {
    std::array<LocalPoint, nodes_at_once> centers;
    for (std::size_t first = begin; first < end; first += nodes_at_once) {
      const std::size_t count = std::min(nodes_at_once, end - first);
      for (std::size_t j = 0; j < nodes_at_once; ++j) {
        const Vec3f& center = spheres[nodes_[first + std::min(j, count - 1)]].center;
        centers[j] = {center.x, center.y, center.z, 0};
      }
      kernels().fit_many(points.data(), {&cores_[core_size * first], &near_[near_size * first], &enough_[first]},
                         centers.data());
      for (std::size_t j = 0; j < count; ++j) spheres[nodes_[first + j]].center = at(centers[j]);
    }
  });
}

namespace {

// Vertices near a place at rest, found through the leaves that own them.
class NearbyPoints {
 public:
  // Borrows all except the tree. Every vertex that a facet uses is owned by some leaf.
  NearbyPoints(const MeshView& rest, const SphereTree& tree, const LeafOrder& order, const Ownership& ownership);
  // Adds the vertices whose distance to the center is at most the radius. Cost: the leaves, and the vertices of near
  // ones.
  void add(const Sphere& around, Marks& points) const;

 private:
  MeshView rest_;
  const Ownership* ownership_;
  std::vector<Sphere> leaf_vertices_;  // per leaf of the order: contains the vertices that it owns
};

NearbyPoints::NearbyPoints(const MeshView& rest, const SphereTree& tree, const LeafOrder& order,
                           const Ownership& ownership)
    : rest_(rest), ownership_(&ownership) {
  for (std::size_t k = 0; k < order.leaves.size(); ++k) {
    const Vec3& center = tree.spheres[order.leaves[k]].center;
    double squared = -1;  // value of a leaf without vertices
    for (const std::uint32_t p : ownership.of_leaf(k))
      if (p < ownership.vertices.size())
        squared = std::max(squared, squared_distance(rest.positions[ownership.vertices[p]], center));
    leaf_vertices_.push_back({center, squared < 0 ? -1 : rounded_up_radius(std::sqrt(squared), max_norm(center))});
  }
}

void NearbyPoints::add(const Sphere& around, Marks& points) const {
  for (std::size_t k = 0; k < leaf_vertices_.size(); ++k) {
    const Sphere& leaf = leaf_vertices_[k];
    if (leaf.radius < 0 || distance(leaf.center, around.center) > (leaf.radius + around.radius) * (1 + 1e-9)) continue;
    for (const std::uint32_t p : ownership_->of_leaf(k)) {
      if (p >= ownership_->vertices.size()) break;  // ascending: cut points follow
      if (distance(rest_.positions[ownership_->vertices[p]], around.center) <= around.radius) points.add(p);
    }
  }
}

constexpr std::size_t cores_per_chunk = PackedCores::nodes_per_chunk;

// One flag per node: whether it has this rule.
std::vector<std::uint8_t> nodes_with(std::span<const Rule> rule_of_node, Rule rule) {
  std::vector<std::uint8_t> flags;
  for (const Rule r : rule_of_node) flags.push_back(r == rule ? 1 : 0);
  return flags;
}

// The points that a node owns, those of one leaf after the other.
std::span<const std::uint32_t> owned_points(const Binding& binding, std::uint32_t node) {
  const std::vector<std::uint32_t>& begin = binding.ownership.begin;
  const std::uint32_t first = begin[binding.order.begin[node]], last = begin[binding.order.end[node]];
  return std::span(binding.ownership.points).subspan(first, last - first);
}

// Writes the outermost points that the node owns; a point may occur more than once. Returns their largest distance at
// rest.
float find_core(const Binding& binding, std::uint32_t node, std::span<std::uint32_t> core) {
  const Vec3f& center = binding.tree_spheres[node].center;
  outermost(binding.local.points(), owned_points(binding, node), center, core);
  float squared = 0;
  kernels().farthest(binding.local.points().data(), {}, core, std::span(&center, 1), &squared);
  return std::sqrt(squared);
}

// Ties the center to points that the node owns, and to vertices not much farther off than its sphere reaches, so that a
// center inside the body finds anchors on all sides. scratch: empty before and after.
void tie_center(const Binding& binding, std::uint32_t node, const NearbyPoints& nearby, Marks& scratch,
                Anchors& anchors) {
  constexpr double reach = 1.3;
  const Sphere& at_rest = binding.model.tree.spheres[node];
  for (const std::uint32_t p : owned_points(binding, node)) scratch.add(p);
  nearby.add({at_rest.center, reach * at_rest.radius}, scratch);
  std::vector<std::uint32_t> candidates;
  scratch.each([&](std::uint32_t p) { candidates.push_back(p); });
  scratch.clear();
  const Spheref& rest = binding.tree_spheres[node];
  anchors.tie(rest.center, rest.radius, binding.local.points(), candidates);
}

}  // namespace

ExactRule::ExactRule(const Binding& binding)
    : walk_(binding.model.tree, binding.order, binding.ownership, nodes_with(binding.rules.of_node, Rule::exact)) {
  // Nodes are independent, so they are processed in parallel; ties are stored in node order.
  const std::size_t node_count = walk_.nodes().size();
  std::vector<std::uint32_t> cores(core_size * node_count), levels;
  std::vector<float> radii(node_count);
  std::vector<Anchors> chunks((node_count + cores_per_chunk - 1) / cores_per_chunk);
  const NearbyPoints nearby(binding.mesh, binding.model.tree, binding.order, binding.ownership);
  parallel_for(binding.workers, node_count, cores_per_chunk, [&](std::size_t begin, std::size_t end) {
    Marks scratch(binding.local.points().size());
    for (std::size_t k = begin; k < end; ++k) {
      radii[k] = find_core(binding, walk_.nodes()[k], std::span(cores).subspan(core_size * k, core_size));
      tie_center(binding, walk_.nodes()[k], nearby, scratch, chunks[begin / cores_per_chunk]);
    }
  });
  for (const Anchors& chunk : chunks) anchors_.append(chunk);
  anchors_.pack();
  for (const std::uint32_t node : walk_.nodes())
    levels.push_back(static_cast<std::uint32_t>(binding.model.tree.level_of(node)));
  cores_ = PackedCores(cores, radii, levels);
  incremental_.emplace(binding, walk_.chains(), anchors_, cores_);
}

std::uint32_t ExactRule::place_of(std::size_t node) const noexcept {
  const std::span<const std::uint32_t> nodes = walk_.nodes();
  return static_cast<std::uint32_t>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
}

void ExactRule::update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                       Workers& workers) noexcept {
  const Uninterrupted whole;
  const std::size_t count = place_of(node_end);
  parallel_for(workers, count, cores_per_chunk,
               [&](std::size_t begin, std::size_t end) { move_centers(begin, end, frame.points, spheres); });
  if (fits_) fits_->move(frame.points, spheres, workers);
  walk_.measure_first(count, frame.points, spheres, workers);
  incremental_->forget();
  rounding_ = frame.rounding;
  parallel_for(workers, count, 4 * cores_per_chunk,
               [&](std::size_t begin, std::size_t end) { set_radii(begin, end, spheres); });
}

void ExactRule::update_one(std::uint32_t node, const RuleFrame& frame, std::span<Spheref> spheres) noexcept {
  const std::uint32_t k = place_of(node);
  spheres[node].center = center(k, frame.points);
  walk_.measure_one(k, frame.points, spheres);
  set_radius(k, rounding_, spheres);
}

std::size_t ExactRule::tested_points(std::size_t node_end) const {
  std::size_t count = 0;
  for (std::uint32_t k = 0; k < place_of(node_end); ++k) count += walk_.points_of(k);
  return count;
}

// Anchors carry the center along; it is pulled to where the sphere grows less if it grew. Centers of spheres that are
// nearly as they were at rest are good already.
Vec3f ExactRule::center(std::uint32_t k, std::span<const LocalPoint> points) const noexcept {
  std::array<std::uint32_t, core_size> core{};
  const auto [first, count] = cores_.of(k);
  for (std::size_t i = 0; i < core_size; ++i) core[i] = first[i < count ? nodes_at_once * i : 0];
  const float rest = cores_.rest_radius(k), enough = most_growth * rest;
  return kernels().pull(points.data(), {core.data(), enough * enough, rest}, anchors_.center(k, points));
}

void ExactRule::move_centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
                             std::span<Spheref> spheres) const noexcept {
  std::array<LocalPoint, cores_per_chunk> centers{};
  anchors_.centers(begin, end, points, centers.data());
  for (std::size_t lane = begin; lane < end; lane += nodes_at_once) {
    const PackedCores::Group group = cores_.group(lane / nodes_at_once);
    std::array<LocalPoint, nodes_at_once> pulled;
    for (std::size_t j = 0; j < nodes_at_once; ++j) pulled[j] = centers[group.nodes[j] - begin];
    kernels().pull_many(points.data(), group.points, group.count, group.rest_radii, pulled.data());
    for (std::size_t j = 0; j < nodes_at_once; ++j) centers[group.nodes[j] - begin] = pulled[j];
  }
  for (std::size_t k = begin; k < end; ++k) {
    const LocalPoint& at = centers[k - begin];
    spheres[walk_.nodes()[k]].center = {at.x, at.y, at.z};
  }
}

void ExactRule::set_radii(std::size_t begin, std::size_t end, std::span<Spheref> spheres) const noexcept {
  std::array<float, 4 * cores_per_chunk> norms, radii;
  for (std::size_t k = begin; k < end; ++k) norms[k - begin] = max_norm(spheres[walk_.nodes()[k]].center);
  kernels().covering_radii(&walk_.squared_reaches()[begin], norms.data(), end - begin, rounding_.allowances(),
                           radii.data());
  for (std::size_t k = begin; k < end; ++k) spheres[walk_.nodes()[k]].radius = radii[k - begin];
}

void ExactRule::set_radius(std::size_t k, const Rounding& rounding, std::span<Spheref> spheres) const noexcept {
  Spheref& sphere = spheres[walk_.nodes()[k]];
  sphere.radius = rounding.covering_radius(walk_.squared_reach(k), sphere.center);
}

std::size_t ExactRule::update_changed(const RuleFrame& frame, const Marks& changed_blocks,
                                      std::span<Spheref> spheres) noexcept {
  const std::size_t tested = incremental_->update({walk_, anchors_, cores_, frame.points, spheres}, changed_blocks);
  const bool rounding_changed = frame.rounding != rounding_;
  rounding_ = frame.rounding;
  // mutant changed-rounding-ignored: `rounding_changed` -> `false`
  if (rounding_changed)
    set_radii_of_all(spheres);
  else
    incremental_->dirty().each([&](std::uint32_t k) { set_radius(k, rounding_, spheres); });
  return tested;
}

void ExactRule::set_radii_of_all(std::span<Spheref> spheres) const noexcept {
  for (std::size_t begin = 0; begin < walk_.nodes().size(); begin += 4 * cores_per_chunk)
    set_radii(begin, std::min(walk_.nodes().size(), begin + 4 * cores_per_chunk), spheres);
}

void ExactRule::fit_leaves(const LeafOrder& order, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                           Workers& workers) {
  std::vector<std::uint32_t> cores;
  for (const std::uint32_t leaf : order.leaves) {
    const std::size_t begin = cores.size();
    const auto [first, count] = cores_.of(place_of(leaf));
    for (std::size_t i = 0; i < count; ++i) cores.push_back(first[nodes_at_once * i]);
    cores.resize(begin + core_size, cores[begin]);
  }
  fits_.emplace(order.leaves, cores, points, spheres, workers);
}

std::unique_ptr<RuleEngine> bind_exact(const Binding& binding) {
  auto engine = std::make_unique<ExactRule>(binding);
  engine->update(binding.rest, binding.spheres.size(), binding.spheres, binding.workers);
  binding.report.corners_owned = engine->walk().owned_points();
  for (std::size_t k = 0; k < engine->anchors().size(); ++k) {
    const CenterTie& tie = engine->anchors()[k];
    binding.report.degenerate_anchors += tie.degenerate;
    binding.report.carried_centers += tie.carries && !tie.degenerate;
  }
  return engine;
}

}  // namespace morula::detail
