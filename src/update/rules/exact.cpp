// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "parallel/interruption.hpp"
#include "update/points/kernels.hpp"
#include "update/points/nearby_points.hpp"
#include "update/points/outermost.hpp"
#include "update/rules/engine_table.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t nodes_per_chunk = PackedCores::nodes_per_chunk;

// One flag per node.
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

// The outermost points that the node owns, some of them more than once. Returns how far they are at rest.
float find_core(const Binding& binding, std::uint32_t node, std::span<std::uint32_t> core) {
  const Vec3f& center = binding.tree_spheres[node].center;
  outermost(binding.local.points(), owned_points(binding, node), center, core);
  float squared = 0;
  kernels().farthest(binding.local.points().data(), {}, core, std::span(&center, 1), &squared);
  return std::sqrt(squared);
}

// To what the node owns, and to vertices not much farther off than its sphere reaches, so that a center inside the body
// finds anchors on all sides. scratch: empty before and after.
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
    : walk_(binding.model.tree, binding.order, binding.ownership, nodes_with(binding.rule_of_node, Rule::exact)) {
  // Nodes are independent, so they are looked at side by side; ties are stored in node order.
  const std::size_t node_count = walk_.nodes().size();
  std::vector<std::uint32_t> cores(core_size * node_count), levels;
  std::vector<float> radii(node_count);
  std::vector<Anchors> chunks((node_count + nodes_per_chunk - 1) / nodes_per_chunk);
  const NearbyPoints nearby(binding.mesh, binding.model.tree, binding.order, binding.ownership);
  parallel_for(binding.workers, node_count, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    Marks scratch(binding.local.points().size());
    for (std::size_t k = begin; k < end; ++k) {
      radii[k] = find_core(binding, walk_.nodes()[k], std::span(cores).subspan(core_size * k, core_size));
      tie_center(binding, walk_.nodes()[k], nearby, scratch, chunks[begin / nodes_per_chunk]);
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
  parallel_for(workers, count, nodes_per_chunk,
               [&](std::size_t begin, std::size_t end) { move_centers(begin, end, frame.points, spheres); });
  if (fits_) fits_->move(frame.points, spheres, workers);
  walk_.measure_first(count, frame.points, spheres, workers);
  incremental_->forget();
  rounding_ = frame.rounding;
  parallel_for(workers, count, 4 * nodes_per_chunk,
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

// Carried along by the anchors; pulled to where the sphere grows less if it grew. Centers of spheres that are nearly as
// they were at rest are good already.
Vec3f ExactRule::center(std::uint32_t k, std::span<const LocalPoint> points) const noexcept {
  std::array<std::uint32_t, core_size> core{};
  const auto [first, count] = cores_.of(k);
  for (std::size_t i = 0; i < core_size; ++i) core[i] = first[i < count ? nodes_at_once * i : 0];
  const float rest = cores_.rest_radius(k), enough = most_growth * rest;
  return kernels().pull(points.data(), {core.data(), enough * enough, rest}, anchors_.center(k, points));
}

void ExactRule::move_centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
                             std::span<Spheref> spheres) const noexcept {
  std::array<LocalPoint, nodes_per_chunk> centers{};
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
  std::array<float, 4 * nodes_per_chunk> norms, radii;
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
  for (std::size_t begin = 0; begin < walk_.nodes().size(); begin += 4 * nodes_per_chunk)
    set_radii(begin, std::min(walk_.nodes().size(), begin + 4 * nodes_per_chunk), spheres);
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
