// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/skin_measured.hpp"

#include <algorithm>

#include "geometry/rounded_up.hpp"
#include "parallel/interruption.hpp"
#include "update/rules/skin_poser.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t vertices_per_chunk = 512;

// One flag per leaf of the order: whether it or a node above it is measured.
std::vector<std::uint8_t> leaves_below(const SphereTree& tree, const LeafOrder& order,
                                       std::span<const std::uint8_t> measured) {
  std::vector<std::uint8_t> flags(order.leaves.size());
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    if (measured[node] != 0)
      // mutant measured-first-leaf: `order.end[node]` -> `order.begin[node] + 1`
      std::fill(flags.begin() + order.begin[node], flags.begin() + order.end[node], std::uint8_t{1});
  return flags;
}

// Flags of the mesh's vertices: those of all facets of which one of these leaves owns a part. Points of the leaves
// depend on no others.
std::vector<std::uint8_t> vertices_of(const MeshView& mesh, const Cover& cover, const LeafOrder& order,
                                      std::span<const std::uint8_t> leaves) {
  std::vector<std::uint8_t> flags(mesh.vertex_count());
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    if (leaves[k] == 0) continue;
    const std::uint32_t leaf = order.leaves[k];
    for (std::uint32_t patch = cover.region_begin[leaf]; patch < cover.region_end[leaf]; ++patch)
      for (const std::uint32_t v : mesh.facets[cover.patch_facet[patch]]) flags[v] = 1;
  }
  return flags;
}

// The points of some leaves, with new numbers in the same order; other leaves own nothing.
Ownership part_of(const Ownership& all, std::span<const std::uint8_t> leaves, std::span<const std::uint8_t> vertices) {
  Ownership part;
  std::vector<std::uint32_t> number(all.vertices.size() + all.cut_points.size());
  for (std::uint32_t i = 0; i < all.vertices.size(); ++i) {
    if (vertices[all.vertices[i]] == 0) continue;
    number[i] = static_cast<std::uint32_t>(part.vertices.size());
    part.vertices.push_back(all.vertices[i]);
  }
  std::vector<std::uint8_t> is_owned(number.size());
  for (std::size_t k = 0; k < leaves.size(); ++k)
    if (leaves[k] != 0)
      for (const std::uint32_t p : all.of_leaf(k)) is_owned[p] = 1;
  for (std::size_t i = 0; i < all.cut_points.size(); ++i) {
    const std::size_t point = all.vertices.size() + i;
    if (is_owned[point] == 0) continue;
    number[point] = static_cast<std::uint32_t>(part.vertices.size() + part.cut_points.size());
    part.cut_points.push_back(all.cut_points[i]);
  }
  part.begin.push_back(0);
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    if (leaves[k] != 0) {
      for (const std::uint32_t p : all.of_leaf(k)) part.points.push_back(number[p]);
      const auto from = all.tested_from_of_leaf(k);
      part.tested_from.insert(part.tested_from.end(), from.begin(), from.end());
    }
    part.begin.push_back(static_cast<std::uint32_t>(part.points.size()));
  }
  return part;
}

// `exact` for the measured nodes: ExactRule serves these.
TreeRules rules_of(std::span<const std::uint8_t> measured) {
  TreeRules rules;
  for (const std::uint8_t flag : measured) rules.of_node.push_back(flag != 0 ? Rule::exact : Rule::skinned);
  return rules;
}

Ownership part_of(const Binding& binding, const Ownership& all, std::span<const std::uint8_t> measured) {
  const std::vector<std::uint8_t> leaves = leaves_below(binding.model.tree, binding.order, measured);
  return part_of(all, leaves, vertices_of(binding.mesh, binding.model.cover, binding.order, leaves));
}

}  // namespace

MeasuredNodes::MeasuredNodes(const Binding& binding, const Ownership& ownership, std::span<const std::uint8_t> measured)
    : MeasuredNodes(binding, part_of(binding, ownership, measured), rules_of(measured)) {}

MeasuredNodes::MeasuredNodes(const Binding& binding, const Ownership& part, const TreeRules& rules)
    : vertices_(part.vertices),
      positions_(binding.mesh.positions.to_vector()),
      local_(binding.mesh, binding.model.cover, part),
      exact_(tied(binding, part, rules)),
      by_bones_(exact_.walk().nodes().size()) {
  std::sort(vertices_.begin(), vertices_.end());
  skin_ = skin_of_vertices(binding.options.skin, vertices_);
  for (const std::uint32_t v : vertices_) rest_.push_back(positions_[v]);
}

ExactRule MeasuredNodes::tied(const Binding& binding, const Ownership& part, const TreeRules& rules) {
  const LocalPoints::Frame rest = local_.move_about(binding.rest.origin, positions_, binding.workers);
  const RuleFrame frame{.origin = rest.origin, .points = local_.points(), .rounding = rest.rounding};
  return ExactRule(Binding{.mesh = binding.mesh,
                           .model = binding.model,
                           .options = binding.options,
                           .rules = rules,
                           .order = binding.order,
                           .ownership = part,
                           .bvh = nullptr,
                           .local = local_,
                           .rest = frame,
                           .posers = binding.posers,
                           .tree_spheres = binding.tree_spheres,
                           .spheres = binding.spheres,
                           .report = binding.report,
                           .workers = binding.workers});
}

void MeasuredNodes::pose(std::span<const AffineTransform> transforms, Workers& workers) noexcept {
  parallel_for(workers, vertices_.size(), vertices_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) positions_[vertices_[i]] = skinned_vertex(skin_, i, rest_[i], transforms);
  });
}

bool MeasuredNodes::measure(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                            Workers& workers) noexcept {
  const Uninterrupted whole;
  pose(frame.bones->transforms, workers);
  const LocalPoints::Frame at = local_.move_about(frame.origin, positions_, workers);
  // mutant measured-range: `!at.finite` -> `false`
  if (!at.finite) return false;
  exact_.update({.origin = at.origin, .points = local_.points(), .rounding = at.rounding}, node_end, spheres, workers);
  for (const std::uint32_t node : nodes()) {
    if (node >= node_end) break;
    float& radius = spheres[node].radius;
    // mutant measured-pad: `+ frame.bones->pad` -> ``
    radius = rounded_up(static_cast<double>(radius) + frame.bones->pad);
  }
  return true;
}

void MeasuredNodes::update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                           Workers& workers) noexcept {
  for (std::size_t k = 0; k < by_bones_.size(); ++k) by_bones_[k] = spheres[nodes()[k]];
  if (!measure(frame, node_end, spheres, workers)) return;
  for (std::size_t k = 0; k < by_bones_.size(); ++k) {
    Spheref& sphere = spheres[nodes()[k]];
    // mutant measured-though-larger: `!(sphere.radius < by_bones_[k].radius)` -> `false`
    if (!(sphere.radius < by_bones_[k].radius)) sphere = by_bones_[k];
  }
}

}  // namespace morula::detail
