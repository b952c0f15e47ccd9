// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Steps that make a body's state: check, rules, points, models, engines.
#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>

#include "geometry/hash.hpp"
#include "update/body_state.hpp"
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
  const double measured = options.details.skinned_measured;
  if (!(measured >= 0 && measured <= 1))
    throw std::invalid_argument("skinned_measured " + std::to_string(measured) + " is not in 0…1");
  for (const Rule rule : options.rules)
    if (!is_rule(rule))
      throw std::invalid_argument("there is no update rule of the number " + std::to_string(static_cast<int>(rule)));
  std::vector<Rule> rules(level_count);
  for (std::size_t level = 0; level < level_count; ++level) rules[level] = rule_of_level(options.rules, level);
  return rules;
}

// The input that a body with these rules follows; throws if it is missing.
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

// The rule of each node. A leaf has no children to read.
std::vector<Rule> rules_of_nodes(const SphereTree& tree, std::span<const Rule> rule_of_level) {
  std::vector<Rule> rules;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node) {
    const Rule rule = rule_of_level[tree.level_of(node)];
    const bool has_nothing = traits(rule).reads == RuleTraits::Reads::children && tree.is_leaf(node);
    rules.push_back(has_nothing ? Rule::exact : rule);
  }
  return rules;
}

// Rules of every level, and of every node.
TreeRules rules_of_tree(const SphereTree& tree, const UpdateOptions& options) {
  TreeRules rules{.of_level = rules_of_levels(options, tree.level_count())};
  rules.of_node = rules_of_nodes(tree, rules.of_level);
  return rules;
}

// Flags of the nodes whose radii are raised to contain their regions.
std::vector<std::uint8_t> raised_nodes(std::span<const Rule> rule_of_node) {
  std::vector<std::uint8_t> flags;
  for (const Rule rule : rule_of_node) flags.push_back(covers_alone(rule) ? 0 : 1);
  return flags;
}

// One flag per leaf of the order: whether it or a node above it tests the corners that it owns.
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
    const auto& rules = binding.rules.of_node;
    if (std::find(rules.begin(), rules.end(), row.rule) == rules.end()) continue;
    if (std::find(bound.begin(), bound.end(), row.bind) != bound.end()) continue;
    bound.push_back(row.bind);
    engines.add(row.bind(binding));
  }
}

// Hash of the tree and of how much each node owns. The spheres separate trees; their regions follow from those and the
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

// Plan of a body: rules and owned points, computed before anything is bound.
struct detail::BodyPlan {
  BodyPlan(const MeshView& mesh_, const CoveredTree& model, const UpdateOptions& options)
      : mesh(mesh_),
        rules(rules_of_tree(model.tree, options)),
        order(depth_first_leaves(model.tree)),
        raises(options.conservative && some_node([](Rule rule) { return !covers_alone(rule); })),
        reads_points(raises || some_node([](Rule rule) { return traits(rule).reads != RuleTraits::Reads::nothing; })),
        reads_links(some_node([](Rule rule) { return traits(rule).reads == RuleTraits::Reads::links; })) {
    const std::vector<std::uint8_t> measured = leaves_measured(model.tree, order, rules.of_node, options.conservative);
    ownership = share_points(mesh, model.cover, order, measured, hull_tolerance);
    share_levels(mesh, model.tree, model.cover, order, hull_tolerance, ownership);
    assert(ownership_faults(mesh, model.tree, model.cover, order, ownership, measured, hull_tolerance).empty());
  }

  MeshView mesh;
  TreeRules rules;
  LeafOrder order;
  bool raises, reads_points, reads_links;
  Ownership ownership;

 private:
  template <class Predicate>
  bool some_node(const Predicate& is_so) const {
    return std::any_of(rules.of_node.begin(), rules.of_node.end(), is_so);
  }
};

std::shared_ptr<Body::State> Body::State::made(const MeshView& mesh, std::shared_ptr<const CoveredTree> model,
                                               UpdateOptions options, Workers& workers) {
  if (!model) throw std::invalid_argument("a body needs a tree and its cover, not a null pointer");
  require_belonging(mesh, *model);
  const BodyPlan plan(mesh, *model, options);
  LocalPoints local(mesh, model->cover, plan.ownership);
  const auto state = std::make_shared<State>(
      State{std::move(model), std::make_shared<const UpdateOptions>(std::move(options)), std::move(local)});
  state->posed.shared = state;
  const LocalPoints::Frame rest = state->local.move(mesh.positions, workers);
  if (!rest.finite)
    throw std::invalid_argument(
        "vertex " + std::to_string(rest.first_bad_vertex) +
        " is too far from the center for an update, or all are too far from the origin: scale "
        "mesh and tree so that coordinates about the center stay below 1e17, others below 1e30");
  state->origin = rest.origin;
  state->models.follows = followed_by(plan.rules.of_level, *state->options);
  narrow_spheres(state->model->tree.spheres, rest.origin, state->spheres);
  state->bind(plan, rest, workers);
  if (plan.raises) state->raise_at_rest(plan, rest.rounding, workers);
  state->note_promises(plan);
  state->show();
  return state;
}

// Binds the models of modes and bones, then the engines, which read them.
void Body::State::bind(const BodyPlan& plan, const LocalPoints::Frame& rest, Workers& workers) {
  const MeshView& mesh = plan.mesh;
  // Only links search facets, so the index is made for them alone: other bodies may be smaller than their index.
  std::optional<TriangleBvh> bvh;
  if (plan.reads_links) bvh.emplace(mesh, workers);
  if (!options->modes.empty()) {
    require_modes(options->modes, mesh);
    models.modal.emplace(mesh, *model, options->modes, plan.ownership.vertices, local.rest_origin(), local.size());
  }
  if (!options->skin.empty()) {
    require_skin(options->skin, mesh);
    models.skin.emplace(mesh, *model, options->skin, plan.ownership.vertices, local.rest_origin(), local.size());
  }
  if (plan.reads_points && (models.modal || models.skin))
    models.rest_positions = models.moved_positions = mesh.positions.to_vector();
  else if (models.modal || models.skin)
    models.vertices.emplace(mesh.positions.to_vector(), *options);

  const std::vector<Spheref> of_tree = spheres;
  const RuleFrame frame{.origin = rest.origin, .points = local.points(), .rounding = rest.rounding};
  const Binding binding{
      .mesh = mesh,
      .model = *model,
      .options = *options,
      .rules = plan.rules,
      .order = plan.order,
      .ownership = plan.ownership,
      .bvh = bvh ? &*bvh : nullptr,
      .local = local,
      .rest = frame,
      .posers = {.modal = models.modal ? &*models.modal : nullptr, .skin = models.skin ? &*models.skin : nullptr},
      .tree_spheres = of_tree,
      .spheres = spheres,
      .report = report,
      .workers = workers};
  bind_engines(binding, engines);
  for (const auto& engine : engines) {
    const auto [vertices, cut_points] = engine->moved_points();
    work.points_tested += engine->tested_points();
    work.vertices_read += vertices;
    work.cut_points_moved += cut_points;
  }
}

void Body::State::raise_at_rest(const BodyPlan& plan, const Rounding& rounding, Workers& workers) {
  raising.emplace(Raising{CornerWalk(model->tree, plan.order, plan.ownership, raised_nodes(plan.rules.of_node)), {}});
  for (const Rule rule : plan.rules.of_node) raising->wraps.push_back(rule == Rule::wrapped ? 1 : 0);
  work.points_tested += raising->walk.tested_points();
  raise(rounding, workers);
}

// Writes the spheres' promises, and the work of a good update.
void Body::State::note_promises(const BodyPlan& plan) {
  const SphereTree& tree = model->tree;
  lazy = LazyFrame(tree.node_count(), options->modes.mode_count);
  posed.cover_id = cover_id_of(*model);
  posed.covers = options->conservative || std::all_of(plan.rules.of_level.begin(), plan.rules.of_level.end(),
                                                      [](Rule rule) { return traits(rule).covers; });
  // A node whose rule reads children contains their spheres; raised radii keep that true.
  posed.nested = true;
  for (std::uint32_t node = 0; node < tree.node_count(); ++node)
    posed.nested = posed.nested && (tree.is_leaf(node) || plan.rules.of_node[node] == Rule::wrapped);
  work.nodes_updated = tree.node_count();
  if (plan.reads_points) {
    work.vertices_read += local.vertex_count();
    work.cut_points_moved += local.cut_point_count();
  }
}

}  // namespace morula
