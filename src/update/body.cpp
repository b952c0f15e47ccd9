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
#include "update/fitted_body.hpp"
#include "update/points/facet_hull.hpp"
#include "update/points/ownership.hpp"
#include "update/points/ownership_check.hpp"
#include "update/rules/engine_table.hpp"

namespace morula {
using namespace detail;
namespace {

// One rule per level of the tree; throws for an empty list and for options out of range.
std::vector<Rule> rules_of_levels(const UpdateOptions& options, std::size_t level_count) {
  if (options.rules.empty()) throw std::invalid_argument("the list of update rules is empty");
  const double floor = options.details.distance_floor;
  if (!(floor >= 0 && floor <= 1))
    throw std::invalid_argument("distance_floor " + std::to_string(floor) + " is not in 0…1");
  for (const Rule rule : options.rules)
    if (!is_rule(rule))
      throw std::invalid_argument("there is no update rule of the number " + std::to_string(static_cast<int>(rule)));
  std::vector<Rule> rules(level_count);
  for (std::size_t level = 0; level < level_count; ++level)
    rules[level] = options.rules[std::min(level, options.rules.size() - 1)];
  return rules;
}

// What moves a body with these rules; throws where it is not there.
RuleTraits::Follows followed_by(std::span<const Rule> rules, const UpdateOptions& options) {
  const Rule* first = nullptr;
  for (const Rule& rule : rules) {
    const RuleTraits::Follows follows = traits(rule).follows;
    if (follows == RuleTraits::Follows::positions) continue;
    if (follows == RuleTraits::Follows::modes && options.modes.empty())
      throw std::invalid_argument("the rule " + std::string(name(rule)) +
                                  " needs the modes of a modal model (UpdateOptions::modes)");
    if (follows == RuleTraits::Follows::bones && options.skin.empty())
      throw std::invalid_argument("the rule " + std::string(name(rule)) + " needs a skin (UpdateOptions::skin)");
    if (first != nullptr && traits(*first).follows != follows)
      throw std::invalid_argument("no update can move both " + std::string(name(*first)) + " and " +
                                  std::string(name(rule)) + ": they follow different things");
    first = &rule;
  }
  return first == nullptr ? RuleTraits::Follows::positions : traits(*first).follows;
}

// What each node follows. A leaf has no children to read.
std::vector<Rule> rules_of_nodes(const SphereTree& tree, std::span<const Rule> rule_of_level) {
  std::vector<Rule> rules;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const Rule rule = rule_of_level[tree.level_of(node)];
    const bool has_nothing = traits(rule).reads == RuleTraits::Reads::children && tree.is_leaf(node);
    rules.push_back(has_nothing ? Rule::exact : rule);
  }
  return rules;
}

// Nodes whose radii are raised to what they own.
std::vector<std::uint8_t> raised_nodes(std::span<const Rule> rule_of_node) {
  std::vector<std::uint8_t> flags;
  for (const Rule rule : rule_of_node) flags.push_back(covers_alone(rule) ? 0 : 1);
  return flags;
}

// One flag per leaf of the order: does it or a node above it look at the corners that it owns?
std::vector<std::uint8_t> leaves_measured(const SphereTree& tree, const LeafOrder& order,
                                          std::span<const Rule> rule_of_node, bool conservative) {
  std::vector<std::uint8_t> flags;
  for (const std::uint32_t leaf : order.leaves) {
    bool measured = false;
    for (std::uint32_t node = leaf; node != no_node && !measured; node = tree.parent[node])
      measured = traits(rule_of_node[node]).reads == RuleTraits::Reads::corners ||
                 (conservative && !covers_alone(rule_of_node[node]));
    flags.push_back(measured ? 1 : 0);
  }
  return flags;
}

// One engine for all the rules that it serves.
void bind_engines(const Binding& binding, EngineList& engines) {
  std::vector<BindEngine*> bound;
  for (const EngineRow& row : engine_table) {
    const auto& rules = binding.rule_of_node;
    if (std::find(rules.begin(), rules.end(), row.rule) == rules.end()) continue;
    if (std::find(bound.begin(), bound.end(), row.bind) != bound.end()) continue;
    bound.push_back(row.bind);
    engines.add(row.bind(binding));
  }
}

// Of the tree and of how much each node owns. The spheres tell trees apart; what they own follows from those and the
// mesh.
std::uint64_t cover_id_of(const CoveredTree& model) {
  Hasher hash;
  hash.add(tree_hash(model.tree));
  hash.add(model.cover.vertex_count);
  hash.add(model.cover.facet_count);
  for (const std::uint32_t end : model.cover.region_end) hash.add(end);
  return hash.value();
}

}  // namespace

Body::Body(const Mesh& mesh, const CoveredTree& model, UpdateOptions options, Workers& workers)
    : Body(mesh, std::make_shared<const CoveredTree>(model), std::move(options), workers) {}

Body::Body(const Mesh& mesh, CoveredTree&& model, UpdateOptions options, Workers& workers)
    : Body(mesh, std::make_shared<const CoveredTree>(std::move(model)), std::move(options), workers) {}

Body::Body(const Mesh& mesh, std::shared_ptr<const CoveredTree> shared, UpdateOptions options, Workers& workers) {
  const StandardFloats standard;
  if (!shared) throw std::invalid_argument("a body needs a tree and its cover, not a null pointer");
  const CoveredTree& model = *shared;
  require_belonging(mesh, model);
  const std::vector<Rule> rule_of_level = rules_of_levels(options, model.tree.level_count());
  const LeafOrder order = depth_first_leaves(model.tree);
  const std::vector<Rule> rule_of_node = rules_of_nodes(model.tree, rule_of_level);
  const std::vector<std::uint8_t> measured = leaves_measured(model.tree, order, rule_of_node, options.conservative);
  Ownership ownership = share_points(mesh, model.cover, order, measured, hull_tolerance);
  share_levels(mesh, model.tree, model.cover, order, hull_tolerance, ownership);
  assert(ownership_faults(mesh, model.tree, model.cover, order, ownership, measured, hull_tolerance).empty());
  state_ =
      std::make_shared<State>(State{std::move(shared), std::move(options), LocalPoints(mesh, model.cover, ownership)});
  State& s = *state_;
  s.posed.shared = state_;

  const LocalPoints::Frame rest = s.local.move(mesh.positions, workers);
  if (!rest.finite)
    throw std::invalid_argument(
        "vertex " + std::to_string(rest.first_bad_vertex) +
        " is too far from the center for an update, or all are too far from the origin: scale "
        "mesh and tree so that coordinates about the center stay below 1e17, others below 1e30");
  s.origin = rest.origin;
  s.follows = followed_by(rule_of_level, s.options);
  narrow_spheres(model.tree.spheres, rest.origin, s.spheres);
  const std::vector<Spheref> of_tree = s.spheres;
  const auto some_node = [&](const auto& is_so) {
    return std::any_of(rule_of_node.begin(), rule_of_node.end(), is_so);
  };
  // Nobody else looks for facets: other bodies may be smaller than what an index of facets takes.
  std::optional<TriangleBvh> bvh;
  if (some_node([](Rule rule) { return traits(rule).reads == RuleTraits::Reads::links; })) bvh.emplace(mesh, workers);
  if (!s.options.modes.empty()) {
    require_modes(s.options.modes, mesh);
    s.modal.emplace(mesh, model, s.options.modes, ownership.vertices, s.local.rest_origin(), s.local.size());
  }
  if (!s.options.skin.empty()) {
    require_skin(s.options.skin, mesh);
    s.skin.emplace(mesh, model, s.options.skin, ownership.vertices, s.local.rest_origin(), s.local.size());
  }
  const bool raises = s.options.conservative && some_node([](Rule rule) { return !covers_alone(rule); });
  const bool reads_points =
      raises || some_node([](Rule rule) { return traits(rule).reads != RuleTraits::Reads::nothing; });
  if (reads_points && (s.modal || s.skin)) s.rest_positions = s.moved_positions = mesh.positions;

  const RuleFrame frame{.origin = rest.origin, .points = s.local.points(), .rounding = rest.rounding};
  const Binding binding{.mesh = mesh,
                        .model = model,
                        .options = s.options,
                        .rule_of_level = rule_of_level,
                        .rule_of_node = rule_of_node,
                        .order = order,
                        .ownership = ownership,
                        .bvh = bvh ? &*bvh : nullptr,
                        .local = s.local,
                        .rest = frame,
                        .modal_poser = s.modal ? &*s.modal : nullptr,
                        .skin_poser = s.skin ? &*s.skin : nullptr,
                        .tree_spheres = of_tree,
                        .spheres = s.spheres,
                        .report = s.report,
                        .workers = workers};
  bind_engines(binding, s.engines);
  for (const auto& engine : s.engines) s.work.points_tested += engine->tested_points();
  if (raises) {
    s.raised.emplace(model.tree, order, ownership, raised_nodes(rule_of_node));
    for (const Rule rule : rule_of_node) s.wraps.push_back(rule == Rule::wrapped ? 1 : 0);
    s.work.points_tested += s.raised->tested_points();
    s.raise(rest.rounding, workers);
  }
  s.cover_id = cover_id_of(model);
  s.reached.resize(model.tree.node_count());
  s.coordinates_reached.resize(s.options.modes.mode_count);
  s.posed.covers = s.options.conservative || std::all_of(rule_of_level.begin(), rule_of_level.end(),
                                                         [](Rule rule) { return traits(rule).covers; });
  // A node of one that reads children contains their spheres; raised radii see to that, too.
  s.posed.nested = true;
  for (std::uint32_t node = 0; node < model.tree.node_count(); ++node)
    s.posed.nested = s.posed.nested && (model.tree.is_leaf(node) || rule_of_node[node] == Rule::wrapped);
  s.show();
  s.work.nodes_updated = model.tree.node_count();
  if (reads_points) {
    s.work.vertices_read = s.local.vertex_count();
    s.work.cut_points_moved = s.local.cut_point_count();
  }
}

// Colliders keep the state for longer: it is not to look like a body that stands still.
void Body::end() noexcept {
  // mutant body-assigned-to: `if (state_) state_->posed.current = false, state_->posed.ended = true` -> ``
  if (state_) state_->posed.current = false, state_->posed.ended = true;
}

Body::~Body() {
  end();
}
Body::Body(const Body& other) : state_(std::make_shared<State>(*other.state_)) {
  State& s = *state_;
  s.posed.shared = state_;
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
Body& Body::operator=(Body&& other) noexcept {
  if (this == &other) return *this;
  end();
  state_ = std::move(other.state_);
  return *this;
}

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

UpdateStatus Body::update_skinned(std::span<const AffineTransform> transforms, Workers& workers) noexcept {
  const StandardFloats standard;
  return state_->shown(state_->counted(state_->follow(transforms, workers)));
}

UpdateStatus Body::update_lazily(const PositionView& positions, std::size_t level, Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  if (!s.is_lazy(RuleTraits::Follows::positions)) return update(positions, workers);
  const std::size_t nodes = s.nodes_to_level(level);
  return s.shown(s.counted_lazily(s.follow_lazily(positions, nodes, workers), nodes), &positions);
}

UpdateStatus Body::update_modal_lazily(std::span<const double> coordinates, std::size_t level,
                                       Workers& workers) noexcept {
  const StandardFloats standard;
  State& s = *state_;
  if (!s.is_lazy(RuleTraits::Follows::modes)) return update_modal(coordinates, workers);
  const std::size_t nodes = s.nodes_to_level(level);
  return s.shown(s.counted_lazily(s.follow_lazily(coordinates, nodes), nodes));
}

std::size_t Body::refresh_children(std::uint32_t node) noexcept {
  const StandardFloats standard;
  const std::size_t brought = state_->refresh_children(node);
  state_->show();
  return brought;
}

bool Body::is_fresh(std::uint32_t node) const {
  return !state_->lazy || state_->reached[node] != 0;
}

bool Body::is_complete() const {
  return !state_->lazy;
}

Sphere Body::modal_sphere(std::uint32_t node, std::span<const double> coordinates) const noexcept {
  const StandardFloats standard;
  const State& s = *state_;
  std::size_t bad = 0;
  if (s.follows == RuleTraits::Follows::modes && coordinates.size() == s.modal->mode_count() &&
      s.modal->accepts(coordinates, bad)) {
    const ModalPose pose = s.modal->pose(coordinates);
    for (const auto& engine : s.engines)
      if (const auto sphere = engine->sphere_alone(node, {.origin = pose.origin, .modes = &pose}))
        return {pose.origin + Vec3(sphere->center), static_cast<double>(sphere->radius)};
  }
  return {s.model->tree.spheres[node].center, std::numeric_limits<double>::infinity()};
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
  SphereTree tree = state_->model->tree;
  tree.nested = state_->posed.nested;
  copy_spheres(tree.spheres);
  return tree;
}

Certificate Body::certify(const PositionView& positions, Workers& workers) const {
  if (positions.size() != vertex_count())
    throw std::invalid_argument("certify: " + std::to_string(positions.size()) + " positions, but the mesh has " +
                                std::to_string(vertex_count()) + " vertices");
  std::vector<Sphere> now;
  copy_spheres(now);
  return morula::certify(cover(), positions, now, workers);
}

std::uint64_t Body::hash() const {
  Hasher hash;
  hash.add(state_->origin);
  for (const Spheref& s : state_->spheres) hash.add(s);
  return hash.value();
}

const SphereState& Body::sphere_state() const {
  return state_->posed;
}

std::uint64_t Body::frame() const {
  return state_->frames;
}

bool Body::is_current() const {
  return state_->current;
}

std::uint64_t Body::cover_id() const {
  return state_->cover_id;
}

const SphereTree& Body::rest_tree() const {
  return state_->model->tree;
}

const Cover& Body::cover() const {
  return state_->model->cover;
}

const UpdateOptions& Body::options() const {
  return state_->options;
}

const BindReport& Body::bind_report() const {
  return state_->report;
}

std::size_t Body::vertex_count() const {
  return state_->model->cover.vertex_count;
}

Body detail::FittedBody::make(const Mesh& mesh, std::shared_ptr<const CoveredTree> model, bool fits_leaves,
                              Workers& workers) {
  Body body(mesh, std::move(model), {}, workers);
  if (fits_leaves) body.state_->fit_leaves(workers);
  return body;
}

}  // namespace morula
