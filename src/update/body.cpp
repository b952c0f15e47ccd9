// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <limits>
#include <morula/geometry/scale.hpp>
#include <morula/update/body.hpp>
#include <optional>
#include <stdexcept>
#include <string>

#include "geometry/hash.hpp"
#include "parallel/float_environment.hpp"
#include "update/body_state.hpp"
#include "update/points/facet_hull.hpp"
#include "update/points/ownership.hpp"
#include "update/points/ownership_check.hpp"

namespace morula {
namespace {

// One rule per level of the tree; throws for an empty list and for options out of range.
std::vector<Rule> rules_of_levels(const UpdateOptions& options, std::size_t level_count) {
  if (options.rules.empty()) throw std::invalid_argument("the list of update rules is empty");
  const double floor = options.details.distance_floor;
  if (!(floor >= 0 && floor <= 1))
    throw std::invalid_argument("distance_floor " + std::to_string(floor) + " is not in 0…1");
  std::vector<Rule> rules(level_count);
  for (std::size_t level = 0; level < level_count; ++level)
    rules[level] = options.rules[std::min(level, options.rules.size() - 1)];
  if (options.modes.empty() && std::count(rules.begin(), rules.end(), Rule::modal) > 0)
    throw std::invalid_argument("the rule modal needs the modes of a modal model (UpdateOptions::modes)");
  return rules;
}

// What each node follows. A leaf has no children to wrap.
std::vector<Rule> rules_of_nodes(const SphereTree& tree, std::span<const Rule> rule_of_level) {
  std::vector<Rule> rules;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const Rule rule = rule_of_level[tree.level_of(node)];
    rules.push_back(rule == Rule::wrapped && tree.is_leaf(node) ? Rule::exact : rule);
  }
  return rules;
}

// Nodes whose radii are raised to what they own.
std::vector<std::uint8_t> raised_nodes(std::span<const Rule> rule_of_node) {
  std::vector<std::uint8_t> flags;
  for (const Rule rule : rule_of_node) flags.push_back(rule == Rule::exact || rule == Rule::modal ? 0 : 1);
  return flags;
}

// One flag per leaf of the order: does it or a node above it look at the corners that it owns?
std::vector<std::uint8_t> leaves_measured(const SphereTree& tree, const LeafOrder& order,
                                          std::span<const Rule> rule_of_node, bool conservative) {
  std::vector<std::uint8_t> flags;
  for (const std::uint32_t leaf : order.leaves) {
    bool measured = false;
    for (std::uint32_t node = leaf; node != no_node && !measured; node = tree.parent[node])
      measured = rule_of_node[node] == Rule::exact || (conservative && rule_of_node[node] != Rule::modal);
    flags.push_back(measured ? 1 : 0);
  }
  return flags;
}

// Of the tree and of how much each node owns. The spheres tell trees apart; what they own follows from those and the
// mesh.
std::uint64_t ownership_stamp(const Built& built) {
  Hasher hash;
  hash.add(tree_hash(built.tree));
  hash.add(built.cover.vertex_count);
  hash.add(built.cover.facet_count);
  for (const std::uint32_t end : built.cover.region_end) hash.add(end);
  return hash.value();
}

}  // namespace

Body::Body(const Mesh& mesh, const Built& built, UpdateOptions options, Workers& workers)
    : Body(mesh, std::make_shared<const Built>(built), std::move(options), workers) {}

Body::Body(const Mesh& mesh, Built&& built, UpdateOptions options, Workers& workers)
    : Body(mesh, std::make_shared<const Built>(std::move(built)), std::move(options), workers) {}

Body::Body(const Mesh& mesh, std::shared_ptr<const Built> shared, UpdateOptions options, Workers& workers) {
  const StandardFloats standard;
  if (!shared) throw std::invalid_argument("a body needs a tree and its cover, not a null pointer");
  const Built& built = *shared;
  require_belonging(mesh, built);
  const std::vector<Rule> rule_of_level = rules_of_levels(options, built.tree.level_count());
  const LeafOrder order = depth_first_leaves(built.tree);
  const std::vector<Rule> rule_of_node = rules_of_nodes(built.tree, rule_of_level);
  const std::vector<std::uint8_t> measured = leaves_measured(built.tree, order, rule_of_node, options.conservative);
  const Ownership ownership = share_points(mesh, built.cover, order, measured, hull_tolerance);
  assert(ownership_faults(mesh, built.tree, built.cover, order, ownership, measured, hull_tolerance).empty());
  state_ =
      std::make_unique<State>(State{std::move(shared), std::move(options), LocalPoints(mesh, built.cover, ownership)});
  State& s = *state_;

  const LocalPoints::Frame rest = s.local.move(mesh.positions, workers);
  if (!rest.finite)
    throw std::invalid_argument(
        "vertex " + std::to_string(rest.first_bad_vertex) +
        " is too far from the centre for an update, or all are too far from the origin: scale "
        "mesh and tree so that coordinates about the centre stay below 1e17, others below 1e30");
  s.origin = rest.origin;
  narrow_spheres(built.tree.spheres, rest.origin, s.spheres);
  const std::vector<Spheref> of_tree = s.spheres;
  const auto exact_nodes = std::count(rule_of_node.begin(), rule_of_node.end(), Rule::exact);
  const auto modal_nodes = std::count(rule_of_node.begin(), rule_of_node.end(), Rule::modal);
  const auto modal_levels = std::count(rule_of_level.begin(), rule_of_level.end(), Rule::modal);
  const bool has_paper_nodes = exact_nodes + modal_nodes < std::ssize(rule_of_node);
  // A wrapped node follows its children only: such a body may be smaller than what an index of facets takes.
  const bool has_links = std::any_of(rule_of_node.begin(), rule_of_node.end(), [](Rule rule) {
    return rule != Rule::exact && rule != Rule::modal && rule != Rule::wrapped;
  });
  std::optional<TriangleBvh> bvh;
  if (has_links) bvh.emplace(mesh, workers);
  const Binding binding{mesh,    built.tree,    rule_of_node, bvh ? &*bvh : nullptr,
                        s.local, rest.rounding, of_tree,      workers};
  if (!s.options.modes.empty()) {
    require_modes(s.options.modes, mesh);
    s.motion.emplace(mesh, built, s.options.modes, ownership.vertices, s.local.rest_origin(), s.local.size());
    if (modal_levels > 0) s.modal.emplace(mesh, built, rule_of_level, s.options, *s.motion, workers);
    if (modal_levels < std::ssize(rule_of_level)) s.rest_positions = s.moved_positions = mesh.positions;
  }
  if (s.modal) {
    const std::vector<double> at_rest(s.options.modes.mode_count, 0.0);
    s.modal->update(s.motion->pose(at_rest), s.spheres, workers);
  }
  if (exact_nodes > 0) {
    s.exact.emplace(binding, order, ownership);
    s.exact->update(s.local.points(), rest.rounding, s.spheres, workers);
    s.report.corners_owned = s.exact->walk().owned_points();
    s.work.points_tested += s.exact->walk().tested_points();
    for (std::size_t k = 0; k < s.exact->anchors().size(); ++k) {
      const CenterTie& tie = s.exact->anchors()[k];
      s.report.degenerate_anchors += tie.degenerate;
      s.report.carried_centers += tie.carries && !tie.degenerate;
    }
  }
  if (has_paper_nodes) {
    s.paper.emplace(binding, s.options.details, s.spheres, s.report);
    s.work.points_tested += s.paper->tested_points();
  }
  if (s.options.conservative && s.paper) {
    s.raised.emplace(built.tree, order, ownership, raised_nodes(rule_of_node));
    s.work.points_tested += s.raised->tested_points();
    s.raise(rest.rounding, workers);
  }
  s.ownership = ownership_stamp(built);
  s.reached.resize(built.tree.node_count());
  s.coordinates_reached.resize(s.options.modes.mode_count);
  s.posed.covers = s.options.conservative || std::all_of(rule_of_level.begin(), rule_of_level.end(), [](Rule rule) {
                     return rule == Rule::exact || rule == Rule::wrapped || rule == Rule::modal;
                   });
  s.show();
  s.work.nodes_updated = built.tree.node_count();
  if (modal_levels < std::ssize(rule_of_level)) {
    s.work.vertices_read = s.local.vertex_count();
    s.work.cut_points_moved = s.local.cut_point_count();
  }
}

Body::~Body() = default;
Body::Body(const Body& other) : state_(std::make_unique<State>(*other.state_)) {
  State& s = *state_;
  s.show();
  const std::vector<Vec3>& others = other.state_->moved_positions;
  const bool formed_there = s.posed.positions && !others.empty() &&
                            s.posed.positions->address(0) == reinterpret_cast<const std::byte*>(others.data());
  if (formed_there) s.posed.positions = PositionView(s.moved_positions);
}
Body& Body::operator=(const Body& other) {
  return *this = Body(other);
}
Body::Body(Body&&) noexcept = default;
Body& Body::operator=(Body&&) noexcept = default;

UpdateStatus Body::update(const PositionView& positions, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(positions, workers)), &positions);
}

UpdateStatus Body::update(const PositionView& positions, std::span<const VertexRange> changed,
                          Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(positions, changed, workers)), &positions);
}

UpdateStatus Body::update_modal(std::span<const double> coordinates, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(coordinates, workers)));
}

UpdateStatus Body::update_lazily(const PositionView& positions, std::size_t level, Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  const bool all_exact = s.exact && !s.paper && !s.modal;
  if (!all_exact) return update(positions, workers);
  const std::size_t nodes = s.nodes_to_level(level);
  return s.shown(s.counted_lazily(s.follow_lazily(positions, nodes, workers), nodes), &positions);
}

UpdateStatus Body::update_modal_lazily(std::span<const double> coordinates, std::size_t level,
                                       Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  const bool all_modal = s.modal && !s.paper && !s.exact;
  if (!all_modal) return update_modal(coordinates, workers);
  const std::size_t nodes = s.nodes_to_level(level);
  return s.shown(s.counted_lazily(s.follow_lazily(coordinates, nodes), nodes));
}

std::size_t Body::reach(std::uint32_t node) noexcept {
  const StandardFloats standard;
  const std::size_t brought = state_->reach(node);
  state_->show();
  return brought;
}

bool Body::is_reached(std::uint32_t node) const {
  return !state_->lazy || state_->reached[node] != 0;
}

bool Body::is_complete() const {
  return !state_->lazy;
}

Sphere Body::modal_sphere(std::uint32_t node, std::span<const double> coordinates) const noexcept {
  const StandardFloats standard;
  const State& s = *state_;
  std::size_t bad = 0;
  if (!s.modal || !s.modal->serves(node) || coordinates.size() != s.motion->mode_count() ||
      !s.motion->accepts(coordinates, bad))
    return {s.built->tree.spheres[node].center, std::numeric_limits<double>::infinity()};
  const ModalPose pose = s.motion->pose(coordinates);
  const Spheref sphere = s.modal->sphere(node, pose);
  return {pose.origin + Vec3(sphere.center), static_cast<double>(sphere.radius)};
}

std::span<const Spheref> Body::spheres() const {
  return state_->spheres;
}

Vec3 Body::origin() const {
  return state_->origin;
}

Sphere Body::sphere(std::uint32_t node) const {
  const StandardFloats standard;
  const Spheref& s = state_->spheres[node];
  return {state_->origin + Vec3(s.center), static_cast<double>(s.radius)};
}

void Body::copy_spheres(std::vector<Sphere>& spheres) const {
  spheres.resize(state_->spheres.size());
  const StandardFloats standard;
  const Vec3 origin = state_->origin;
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    const Spheref& s = state_->spheres[i];
    spheres[i] = {origin + Vec3(s.center), static_cast<double>(s.radius)};
  }
}

SphereTree Body::current_tree() const {
  SphereTree tree = state_->built->tree;
  copy_spheres(tree.spheres);
  return tree;
}

std::uint64_t Body::hash() const {
  Hasher hash;
  hash.add(state_->origin);
  for (const Spheref& s : state_->spheres) hash.add(s);
  return hash.value();
}

const PosedTree& Body::pose() const {
  return state_->posed;
}

std::uint64_t Body::frame() const {
  return state_->frames;
}

bool Body::is_current() const {
  return state_->current;
}

std::uint64_t Body::ownership() const {
  return state_->ownership;
}

const SphereTree& Body::rest_tree() const {
  return state_->built->tree;
}

const Cover& Body::cover() const {
  return state_->built->cover;
}

const UpdateOptions& Body::options() const {
  return state_->options;
}

const BindReport& Body::bind_report() const {
  return state_->report;
}

std::size_t Body::vertex_count() const {
  return state_->built->cover.vertex_count;
}

}  // namespace morula
