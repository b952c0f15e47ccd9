// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/exact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "parallel/interruption.hpp"
#include "update/points/kernels.hpp"
#include "update/points/nearby_points.hpp"
#include "update/points/outermost.hpp"
#include "update/rules/engine_table.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t nodes_per_chunk = 64;

// One flag per node.
std::vector<std::uint8_t> nodes_with(std::span<const Rule> rule_of_node, Rule rule) {
  std::vector<std::uint8_t> flags;
  for (const Rule r : rule_of_node) flags.push_back(r == rule ? 1 : 0);
  return flags;
}

}  // namespace

ExactRule::ExactRule(const Binding& binding)
    : walk_(binding.built.tree, binding.order, binding.ownership, nodes_with(binding.rule_of_node, Rule::exact)) {
  const SphereTree& tree = binding.built.tree;
  const LeafOrder& order = binding.order;
  const Ownership& ownership = binding.ownership;
  // Nodes are independent, so they are looked at side by side; ties are stored in node order.
  const std::size_t node_count = walk_.nodes().size();
  std::vector<std::uint32_t> cores(core_size * node_count);
  std::vector<float> radii(node_count);
  std::vector<Anchors> chunks((node_count + nodes_per_chunk - 1) / nodes_per_chunk);
  const NearbyPoints nearby(binding.mesh, tree, order, ownership);
  parallel_for(binding.workers, node_count, nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    Marks points(binding.local.points().size());
    std::vector<std::uint32_t> candidates;
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t node = walk_.nodes()[k];
      const std::uint32_t first = ownership.begin[order.begin[node]], last = ownership.begin[order.end[node]];
      const auto owned = std::span(ownership.points).subspan(first, last - first);
      const std::span<std::uint32_t> core = std::span(cores).subspan(core_size * k, core_size);
      const Vec3f& center = binding.tree_spheres[node].center;
      outermost(binding.local.points(), owned, center, core);
      float squared = 0;
      kernels().farthest(binding.local.points().data(), {}, core, std::span(&center, 1), &squared);
      radii[k] = std::sqrt(squared);
      // What the node owns, and vertices not much farther off than its sphere reaches, so that a centre inside the body
      // finds anchors on all sides.
      constexpr double reach = 1.3;
      const Sphere& at_rest = tree.spheres[node];
      for (const std::uint32_t p : owned) points.add(p);
      nearby.add({at_rest.center, reach * at_rest.radius}, points);
      candidates.clear();
      points.each([&](std::uint32_t p) { candidates.push_back(p); });
      points.clear();
      const Spheref& rest = binding.tree_spheres[node];
      chunks[begin / nodes_per_chunk].tie(rest.center, rest.radius, binding.local.points(), candidates);
    }
  });
  for (const Anchors& chunk : chunks) anchors_.append(chunk);
  anchors_.pack();
  pack_cores(binding, cores, radii);
  find_dependents(binding);
}

// cores: core_size points of each node, some of them more than once.
void ExactRule::pack_cores(const Binding& binding, std::span<const std::uint32_t> cores, std::span<const float> radii) {
  const std::size_t node_count = radii.size();
  // Once each, in the order of the list, which is what counts among equals.
  std::vector<std::vector<std::uint32_t>> core_of(node_count);
  for (std::size_t k = 0; k < node_count; ++k)
    for (const std::uint32_t p : cores.subspan(core_size * k, core_size))
      if (std::find(core_of[k].begin(), core_of[k].end(), p) == core_of[k].end()) core_of[k].push_back(p);

  lane_.resize(node_count);
  core_begin_.push_back(0);
  std::vector<std::uint32_t> order;
  for (std::size_t begin = 0; begin < node_count; begin += nodes_per_chunk) {
    order.resize(std::min(nodes_per_chunk, node_count - begin));
    std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
    // By levels first: whoever asks for upper levels alone asks for the first groups.
    const auto key = [&](std::uint32_t k) {
      return std::tuple(binding.built.tree.level_of(walk_.nodes()[k]), core_of[k].size(), k);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    for (std::size_t first = 0; first < order.size(); first += nodes_at_once) {
      std::size_t count = 0;
      for (std::size_t j = 0; j < nodes_at_once; ++j) {
        const std::uint32_t k = order[std::min(first + j, order.size() - 1)];
        if (first + j < order.size()) lane_[k] = static_cast<std::uint32_t>(node_of_lane_.size());
        node_of_lane_.push_back(k);
        core_radius_.push_back(radii[k]);
        count = std::max(count, core_of[k].size());
      }
      const auto nodes = std::span(node_of_lane_).last(nodes_at_once);
      for (std::size_t i = 0; i < count; ++i)
        for (const std::uint32_t k : nodes) core_.push_back(core_of[k][i < core_of[k].size() ? i : 0]);
      core_begin_.push_back(static_cast<std::uint32_t>(core_.size()));
    }
  }
}

std::size_t ExactRule::place_of(std::size_t node) const noexcept {
  const std::span<const std::uint32_t> nodes = walk_.nodes();
  return static_cast<std::size_t>(std::lower_bound(nodes.begin(), nodes.end(), node) - nodes.begin());
}

void ExactRule::update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                       Workers& workers) noexcept {
  const Uninterrupted whole;
  const std::size_t count = place_of(node_end);
  parallel_for(workers, count, nodes_per_chunk,
               [&](std::size_t begin, std::size_t end) { move_centers(begin, end, frame.points, spheres); });
  if (fits_) fits_->move(frame.points, spheres, workers);
  walk_.measure_first(count, frame.points, spheres, workers);
  rounding_ = frame.rounding;
  parallel_for(workers, count, 4 * nodes_per_chunk,
               [&](std::size_t begin, std::size_t end) { set_radii(begin, end, spheres); });
}

void ExactRule::update_one(std::uint32_t node, const RuleFrame& frame, std::span<Spheref> spheres) noexcept {
  const std::size_t k = place_of(node);
  spheres[node].center = center(k, frame.points);
  walk_.measure_one(k, frame.points, spheres);
  set_radius(k, rounding_, spheres);
}

std::size_t ExactRule::tested_points(std::size_t node_end) const {
  std::size_t count = 0;
  for (std::size_t k = 0; k < place_of(node_end); ++k) count += walk_.points_of(k);
  return count;
}

// Carried along by the anchors; pulled to where the sphere grows less if it grew. Centres of spheres that are nearly as
// they were at rest are good already.
Vec3f ExactRule::center(std::size_t k, std::span<const LocalPoint> points) const noexcept {
  std::array<std::uint32_t, core_size> core{};
  const auto [first, count] = core_of(k);
  for (std::size_t i = 0; i < core_size; ++i) core[i] = first[i < count ? nodes_at_once * i : 0];
  const float rest = core_radius_[lane_[k]], enough = most_growth * rest;
  return kernels().pull(points.data(), {core.data(), enough * enough, rest}, anchors_.center(k, points));
}

void ExactRule::move_centers(std::size_t begin, std::size_t end, std::span<const LocalPoint> points,
                             std::span<Spheref> spheres) const noexcept {
  static_assert(nodes_per_chunk % nodes_at_once == 0 && nodes_at_once % nodes_per_group == 0);
  std::array<LocalPoint, nodes_per_chunk> centers{};
  anchors_.centers(begin, end, points, centers.data());
  for (std::size_t lane = begin; lane < end; lane += nodes_at_once) {
    const std::size_t group = lane / nodes_at_once;
    const std::uint32_t* const nodes = &node_of_lane_[lane];
    std::array<LocalPoint, nodes_at_once> pulled;
    for (std::size_t j = 0; j < nodes_at_once; ++j) pulled[j] = centers[nodes[j] - begin];
    kernels().pull_many(points.data(), &core_[core_begin_[group]],
                        (core_begin_[group + 1] - core_begin_[group]) / nodes_at_once, &core_radius_[lane],
                        pulled.data());
    for (std::size_t j = 0; j < nodes_at_once; ++j) centers[nodes[j] - begin] = pulled[j];
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

void ExactRule::set_radii_of_all(std::span<Spheref> spheres) const noexcept {
  for (std::size_t begin = 0; begin < walk_.nodes().size(); begin += 4 * nodes_per_chunk)
    set_radii(begin, std::min(walk_.nodes().size(), begin + 4 * nodes_per_chunk), spheres);
}

void ExactRule::fit_leaves(const LeafOrder& order, std::span<const LocalPoint> points, std::span<const Spheref> spheres,
                           Workers& workers) {
  std::vector<std::uint32_t> cores;
  for (const std::uint32_t leaf : order.leaves) {
    const std::size_t begin = cores.size();
    const auto [first, count] = core_of(place_of(leaf));
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
