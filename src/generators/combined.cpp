// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lists of reducers, and the generators made of them.

#include <algorithm>
#include <optional>

#include "generators/divide/demand.hpp"
#include "generators/divide/exchange.hpp"
#include "generators/divide/flat_set.hpp"
#include "generators/methods.hpp"
#include "generators/reduce/adaptive_medial.hpp"
#include "generators/reduce/ball_set.hpp"
#include "generators/reduce/optimize.hpp"
#include "generators/reduce/reducers.hpp"

namespace morula::detail {
namespace {

bool reduces_medial_balls(Reduction r) {
  return r == Reduction::merge || r == Reduction::burst || r == Reduction::expand;
}

void append(Proposals& all, Proposals more) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

// Quick fits for the methods that are quick themselves; thorough ones for slow methods, which estimate from a draft
// tree where small spheres will be needed.
constexpr ReduceSettings quick{
    .fit = {.spacing = 0.15, .cell = 0.25, .cells_per_radius = 4, .balance = 0, .exact_rounds = 2},
    .changes = {4, 4, 4},
    .move_every = 5};
constexpr ReduceSettings thorough{
    .fit = {.spacing = 0.1, .cell = 0.2, .cells_per_radius = 4, .balance = 0, .exact_rounds = 3},
    .changes = {40, 12, 8},
    .move_every = 2,
    .all_on_root = true,
    .balance = {2.5F, 2.0F}};

CoveredTree build_reduced(const MeshView& mesh, const BuildRun& run, Workers& workers,
                          std::vector<Reduction> reductions, const ReduceSettings& settings) {
  std::optional<ObjectShape> object(std::in_place, mesh, workers);
  const ObjectShape& shape = *object;
  const ObjectLines lines(mesh, shape, cells_for(run, mesh, shape), workers);
  const FitInput input = fit_input(mesh, shape, lines);
  const LevelHook exchange_parts = [&](std::vector<BuildNode>& nodes) {
    constexpr int rounds = 2;
    if (nodes[0].level >= 2) exchange(input, nodes, rounds, workers);
  };
  Reducer reducer = combined_reducer(std::move(reductions), run);
  if (is_flat_set(run)) {
    const ObjectLines fine(mesh, shape, flat_set_cells, workers);
    const FitInput fine_input = fit_input(mesh, shape, fine);
    const auto divider = [&](const FitInput& by, const BuildRun& level) {
      return divide_by(by, level, reducer, settings);
    };
    const auto one_level = [&](std::size_t most) { return divider(input, run.one_level(most)); };
    const FlatSetBy by{.one_level = one_level,
                       .parts = one_level,
                       .levels = [&](int depth) { return divider(fine_input, of_levels(run, depth)); },
                       .improve =
                           [&](std::vector<BuildNode>& nodes) {
                             constexpr int rounds = 2;
                             exchange(fine_input, nodes, rounds, workers);
                           },
                       .quick = true};
    return flat_set(input, fine, run, by, workers);
  }
  const auto driven = [&](const BuildRun& by, const Demand& demand) {
    return top_down(mesh, by,
                    {.divide = divide_by(input, by, std::move(reducer), settings, demand),
                     .new_level = exchange_parts,
                     .distance = &shape.distance(),
                     .lines = &lines,
                     .divided = [&] { object.reset(); }},
                    workers);
  };
  if (settings.balance[0] == 0 || run.depth < 2 || is_worst_first(run)) return driven(run, {});
  constexpr double first_share = 0.2;
  const Demand demand = demand_from(input, fast_tree(input, run.pass(0, first_share), workers), workers);
  return driven(run.pass(first_share, 1), demand);
}

std::vector<Reduction> chosen_or(const BuildOptions& options, const std::vector<Reduction>& usual) {
  return options.reducers.empty() ? usual : options.reducers;
}

}  // namespace

Proposals propose_medial(const ReducerInput& node, std::span<const Reduction> reductions) {
  const BallSet set = adaptive_medial(node);
  const auto grown = [&](const Reduced& reduced) {
    return equally_grown(reduced.balls, reduced.distances, node.samples);
  };
  Proposals proposals;
  for (const Reduction r : reductions) {
    std::vector<Sphere> spheres;
    if (r == Reduction::merge) spheres = grown(merge(set, node.branching, node.shape.distance()));
    if (r == Reduction::burst) spheres = grown(burst(set, node.branching, node.shape.distance()));
    if (r == Reduction::expand) spheres = expand(set, node.branching);
    if (!spheres.empty()) proposals.push_back({name(r), std::move(spheres)});
  }
  return proposals;
}

Reducer combined_reducer(std::vector<Reduction> reductions, const BuildOptions& options) {
  const bool any_medial = std::any_of(reductions.begin(), reductions.end(), reduces_medial_balls);
  return [reductions = std::move(reductions), any_medial, optimizer = options.optimizer,
          excess = options.balance_excess](const ReducerInput& node) {
    Proposals all;
    for (const Reduction r : reductions) {
      if (r == Reduction::grid) append(all, propose_grid(node));
      if (r == Reduction::hubbard) append(all, propose_hubbard(node));
      if (r == Reduction::spawn) append(all, propose_spawn(node));
    }
    if (any_medial) append(all, propose_medial(node, reductions));
    std::erase_if(all, [](const Proposal& p) { return p.spheres.empty(); });
    for (Proposal& p : all) optimize(p, node, optimizer, excess);
    if (all.empty()) all.push_back({no_proposal, {node.sphere}});
    return all;
  };
}

CoveredTree build_grid(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, {Reduction::grid}, quick);
}
CoveredTree build_hubbard(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, {Reduction::hubbard}, quick);
}
CoveredTree build_spawn(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, {Reduction::spawn}, quick);
}
CoveredTree build_medial(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, chosen_or(run, {Reduction::merge, Reduction::expand}), thorough);
}
CoveredTree build_combined(const MeshView& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers,
                       chosen_or(run, {Reduction::grid, Reduction::spawn, Reduction::merge, Reduction::expand}),
                       thorough);
}

}  // namespace morula::detail
