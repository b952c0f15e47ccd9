// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Two bounds of a node's corners, both of [james2004]'s form. With c the center and y a corner's place about it at
// rest, the corner is at c + y + sum q_j u_j. With u_j = s_j + e_j, |e_j| <= stray:
//   shifts      |corner - (c + sum q_j s_j)| <= |y| + sum |q_j| stray_j, which is the paper's
// With u_j = G_j y + s_j + e_j and F = 1 + sum q_j G_j:
//   gradients   |corner - (c + sum q_j s_j)| <= |F| |y| + sum |q_j| stray_j
// The second lets strain and turning act together instead of adding their lengths, and its strays are of second order
// in the size of the node; the first is better where displacements are rough. The smaller sphere is taken, node by
// node.
//
// Rounding, all in double, e = 2^-53. m modes; Z bounds |coordinates| of all summands: rest positions and centers, plus
// sum |q_j| times the largest |component| of a row, a shift or, over a node, 3 |G| |y|. The terms are lengths:
//   the caller's own sum rest + U q, and ours of shifts               2 x 1.8 (m + 1) e Z
//   the entries of F, times |y| <= 3.5 Z                              10.4 (m + 1) e Z
//   cut corners as weighted sums, of rows here and of positions there     10.4 e Z
//   reading: origin + center, distances of a certificate              below 10 e Z
// Allowed: 16 (m + 16) e Z. Cut corners that lie in the hull of others are left out (exactly in it: facet_hull.hpp with
// tolerance 0). If weights add up to 1 +- s, the first weights of a corner and of the ones around it differ by up to 2
// s, which is below 3.5 s Z as a length; allowed: 4 s Z. The rounding of binding a node is in its strays and its radius
// (rounded_up_radius); the motion of the center by narrowing to float is measured.
#include "update/rules/modal.hpp"

#include <cassert>
#include <stdexcept>
#include <string>

#include "parallel/interruption.hpp"
#include "update/points/narrow.hpp"
#include "update/points/ownership.hpp"
#include "update/points/ownership_check.hpp"
#include "update/points/rounding.hpp"
#include "update/rules/engine_table.hpp"

namespace morula::detail {
namespace {

constexpr std::size_t modal_nodes_per_chunk = 32;

// Displacements add up to less than this; with a rest body within largest_local_coordinate, all values computed from
// them stay far inside the range of float.
constexpr double largest_displacement = 0x1p55;

}  // namespace

void require_modes(const Modes& modes, const MeshView& mesh) {
  if (modes.vertex_count != mesh.vertex_count())
    throw std::invalid_argument("the modes are for " + std::to_string(modes.vertex_count) +
                                " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
  // Divided, not multiplied: no count overflows. A usable mesh has vertices.
  if (modes.displacements.size() % modes.vertex_count != 0 ||
      modes.displacements.size() / modes.vertex_count != modes.mode_count)
    throw std::invalid_argument(std::to_string(modes.mode_count) + " modes of " + std::to_string(modes.vertex_count) +
                                " vertices need a displacement each, but there are " +
                                std::to_string(modes.displacements.size()));
  for (std::size_t i = 0; i < modes.displacements.size(); ++i)
    if (!is_finite(modes.displacements[i]))
      throw std::invalid_argument("mode " + std::to_string(i / modes.vertex_count) + ": the displacement of vertex " +
                                  std::to_string(i % modes.vertex_count) + " is not finite");
}

ModalPoser::ModalPoser(const MeshView& mesh, const CoveredTree& model, const Modes& modes,
                       std::span<const std::uint32_t> used_vertices, const Vec3& rest_origin, double size)
    : reach_(modes.mode_count), rest_origin_(rest_origin), size_(size) {
  const std::uint32_t guide = *std::min_element(used_vertices.begin(), used_vertices.end());
  guide_rest_ = mesh.positions[guide];
  for (const std::uint32_t v : used_vertices) rest_reach_ = std::max(rest_reach_, max_norm(mesh.positions[v]));
  for (const Sphere& s : model.tree.spheres) rest_reach_ = std::max(rest_reach_, max_norm(s.center));
  for (const CutPoint& c : model.cover.cut_points)
    weight_slack_ = std::max(weight_slack_, std::abs(c.weight[0] + c.weight[1] + c.weight[2] - 1));
  for (std::size_t j = 0; j < modes.mode_count; ++j) {
    const std::span<const Vec3> mode = modes.mode(j);
    guide_.push_back(mode[guide]);
    for (const std::uint32_t v : used_vertices) reach_[j] = std::max(reach_[j], max_norm(mode[v]));
  }
  largest_row_ = reach_;
}

bool ModalPoser::accepts(std::span<const double> coordinates, std::size_t& first_bad) const noexcept {
  double sum = 0, most = -1;
  first_bad = 0;
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    if (!std::isfinite(coordinates[j])) {
      first_bad = j;
      return false;
    }
    const double displacement = std::abs(coordinates[j]) * reach_[j];
    sum += displacement;
    if (displacement > most) most = displacement, first_bad = j;
  }
  // mutant modal-range: `sum <= largest_displacement` -> `true`
  return sum <= largest_displacement;
}

ModalPose ModalPoser::pose(std::span<const double> coordinates) const noexcept {
  // Moves the guide like move_by_modes.
  Vec3 guide = guide_rest_;
  double largest = rest_reach_;
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    if (coordinates[j] == 0) continue;
    guide += coordinates[j] * guide_[j];
    largest += std::abs(coordinates[j]) * largest_row_[j];
  }
  const Vec3 origin = origin_near(rest_origin_ + (guide - guide_rest_), size_);
  // mutant modal-pad-of-few-modes: `(static_cast<double>(coordinates.size()) + 16)` -> `16`
  // mutant modal-pad-less: `49` -> `54`
  // mutant modal-weight-slack: `4 *` -> `0.5 *`
  const double share = 0x1p-49 * (static_cast<double>(coordinates.size()) + 16) + 4 * weight_slack_;
  // mutant modal-pad: `share * (largest + max_norm(origin))` -> `0 * share`
  return {coordinates, origin, share * (largest + max_norm(origin))};
}

MorphedRest ModalPoser::morphed(std::span<const double> coordinates) const noexcept {
  MorphedRest rest{guide_rest_};
  for (std::size_t j = 0; j < coordinates.size(); ++j) {
    if (coordinates[j] == 0) continue;
    rest.guide += coordinates[j] * guide_[j];
    rest.motion += std::abs(coordinates[j]) * reach_[j];
    ++rest.active;
  }
  if (rest.active != 0) rest.morphs = coordinates;
  return rest;
}

ModalRule::ModalRule(const Binding& binding)
    : mode_count_(binding.options.modes.mode_count), slot_(binding.model.tree.node_count(), no_node) {
  const MeshView& mesh = binding.mesh;
  const CoveredTree& model = binding.model;
  const SphereTree& tree = model.tree;
  const UpdateOptions& options = binding.options;
  for (std::size_t level = 0; level < tree.level_count(); ++level)
    if (binding.rules.of_level[level] == Rule::modal)
      for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
        slot_[node] = static_cast<std::uint32_t>(nodes_.size());
        nodes_.push_back({node});
      }
  rows_.resize(nodes_.size() * mode_count_);
  if (options.details.modal_bound == RuleOptions::ModalBound::gradient) linear_rows_.resize(rows_.size());

  // The rule has its own list of points: those of the other rules leave out cut corners that only this one has to
  // contain.
  const LeafOrder order = depth_first_leaves(tree);
  const std::vector<std::uint8_t> every_leaf(order.leaves.size(), 1);
  // mutant hull-tolerance-for-modes: `0` -> `0x1p-30`
  const Ownership ownership = share_points(mesh, model.cover, order, every_leaf, 0);
  assert(ownership_faults(mesh, tree, model.cover, order, ownership, every_leaf, 0).empty());
  parallel_for(binding.workers, nodes_.size(), 1, [&](std::size_t slot, std::size_t) {
    const std::uint32_t node = nodes_[slot].node;
    nodes_[slot].rest.center = tree.spheres[node].center;
    bind(slot, mesh, model.cover, options.modes,
         corners_of(ownership, model.cover, order.begin[node], order.end[node]));
  });
  for (std::size_t i = 0; i < linear_rows_.size(); ++i) {
    const LinearModeRow& row = linear_rows_[i];
    double steepest = 0;
    for (const Vec3& column : row.gradient) steepest = std::max(steepest, max_norm(column));
    const double across = 3 * steepest * nodes_[i / mode_count_].rest.radius;
    binding.posers.modal->add_row(i % mode_count_, std::max(max_norm(row.shift), across));
  }
}

void ModalRule::bind(std::size_t slot, const MeshView& mesh, const Cover& cover, const Modes& modes,
                     std::span<const std::uint32_t> corners) {
  Sphere& rest = nodes_[slot].rest;
  std::vector<Vec3> places;
  double farthest = 0, largest = 0;
  for (const std::uint32_t c : corners) {
    const Vec3 corner = corner_position(cover, c, mesh.positions);
    places.push_back(corner - rest.center);
    farthest = std::max(farthest, safe_length(places.back()));
    largest = std::max(largest, max_norm(corner));
  }
  const double extent = largest + max_norm(rest.center);
  rest.radius = rounded_up_radius(farthest, extent);

  const LinearFit fit(std::move(places), extent);
  std::vector<Vec3> displacements(corners.size());
  for (std::size_t j = 0; j < mode_count_; ++j) {
    for (std::size_t i = 0; i < corners.size(); ++i)
      displacements[i] = corner_position(cover, corners[i], modes.mode(j));
    rows_[slot * mode_count_ + j] = mode_row(displacements);
    if (!linear_rows_.empty()) linear_rows_[slot * mode_count_ + j] = fit.row(displacements);
  }
}

void ModalRule::update(const RuleFrame& frame, std::size_t node_end, std::span<Spheref> spheres,
                       Workers& workers) noexcept {
  const Uninterrupted whole;
  const auto last = std::lower_bound(nodes_.begin(), nodes_.end(), node_end,
                                     [](const Node& n, std::size_t node) { return n.node < node; });
  const auto count = static_cast<std::size_t>(last - nodes_.begin());
  parallel_for(workers, count, modal_nodes_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t slot = begin; slot < end; ++slot) spheres[nodes_[slot].node] = sphere_of(slot, *frame.modes);
  });
}

Spheref ModalRule::sphere_of(std::size_t slot, const ModalPose& pose) const noexcept {
  Sphere s = by_shifts(slot, pose.coordinates);
  if (!linear_rows_.empty())
    if (const Sphere other = by_gradients(slot, pose.coordinates); other.radius < s.radius) s = other;
  const Vec3 center = s.center - pose.origin;
  // Adding zero makes a negative zero positive, like the other rules.
  const Vec3f nearest = Vec3f(center) + Vec3f{};
  // mutant modal-narrowed-center: `s.radius + distance(Vec3(nearest), center)` -> `s.radius`
  return {nearest, rounded_up((s.radius + distance(Vec3(nearest), center)) * (1 + 0x1p-40) + pose.pad)};
}

Sphere ModalRule::by_shifts(std::size_t slot, std::span<const double> coordinates) const noexcept {
  Sphere s = nodes_[slot].rest;
  const ModeRow* row = rows_.data() + slot * mode_count_;
  for (const double q : coordinates) {
    s.center += q * row->shift;
    s.radius += std::abs(q) * row->stray;
    ++row;
  }
  return s;
}

Sphere ModalRule::by_gradients(std::size_t slot, std::span<const double> coordinates) const noexcept {
  const Sphere& rest = nodes_[slot].rest;
  std::array<Vec3, 3> columns{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  Vec3 center = rest.center;
  double stray = 0;
  const LinearModeRow* row = linear_rows_.data() + slot * mode_count_;
  for (const double q : coordinates) {
    for (int k = 0; k < 3; ++k) columns[k] += q * row->gradient[k];
    center += q * row->shift;
    stray += std::abs(q) * row->stray;
    ++row;
  }
  return {center, largest_stretch(columns) * rest.radius + stray};
}

std::unique_ptr<RuleEngine> bind_modal(const Binding& binding) {
  auto engine = std::make_unique<ModalRule>(binding);
  const std::vector<double> at_rest(binding.options.modes.mode_count, 0.0);
  const ModalPose pose = binding.posers.modal->pose(at_rest);
  engine->update({.origin = pose.origin, .modes = &pose}, binding.spheres.size(), binding.spheres, binding.workers);
  return engine;
}

}  // namespace morula::detail
