// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Lists of reducers, and the generators made of them.

#include <algorithm>

#include "build/adaptive_medial.hpp"
#include "build/ball_set.hpp"
#include "build/optimise.hpp"
#include "build/reducers.hpp"

namespace morula {
namespace {

bool reduces_medial_balls(Reduction r) {
  return r == Reduction::merge || r == Reduction::burst || r == Reduction::expand;
}

void append(Proposals& all, Proposals more) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

Built build_reduced(const Mesh& mesh, const BuildRun& run, Workers& workers, std::vector<Reduction> reductions) {
  const SignedDistance shape(mesh, workers);
  run.throw_if_stopped();
  return top_down(mesh, run, {}, divide_by(mesh, run, shape, combined_reducer(std::move(reductions), run)), workers,
                  &shape);
}

std::vector<Reduction> chosen_or(const BuildOptions& options, std::vector<Reduction> usual) {
  return options.reducers.empty() ? std::move(usual) : options.reducers;
}

}  // namespace

Proposals propose_medial(const ReducerInput& node, std::span<const Reduction> reductions) {
  const BallSet set = adaptive_medial(node);
  const auto grown = [&](const Reduced& reduced) {
    return equally_grown(Growth::power, reduced.balls, reduced.distances, node.samples);
  };
  Proposals proposals;
  for (const Reduction r : reductions) {
    std::vector<Sphere> spheres;
    if (r == Reduction::merge) spheres = grown(merge(set, node.branching, node.shape));
    if (r == Reduction::burst) spheres = grown(burst(set, node.branching, node.shape));
    if (r == Reduction::expand) spheres = expand(set, node.branching, Growth::power);
    if (!spheres.empty()) proposals.push_back({name(r), std::move(spheres)});
  }
  return proposals;
}

Reducer combined_reducer(std::vector<Reduction> reductions, const BuildOptions& options) {
  const bool any_medial = std::any_of(reductions.begin(), reductions.end(), reduces_medial_balls);
  return [reductions = std::move(reductions), any_medial, optimiser = options.optimiser,
          excess = options.balance_excess](const ReducerInput& node) {
    Proposals all;
    for (const Reduction r : reductions) {
      if (r == Reduction::grid) append(all, propose_grid(node));
      if (r == Reduction::hubbard) append(all, propose_hubbard(node));
      if (r == Reduction::spawn) append(all, propose_spawn(node));
    }
    if (any_medial) append(all, propose_medial(node, reductions));
    std::erase_if(all, [](const Proposal& p) { return p.spheres.empty(); });
    for (Proposal& p : all) optimise(p, node, optimiser, excess);
    if (all.empty()) all.push_back({no_proposal, {node.sphere}});
    return all;
  };
}

Built build_grid(const Mesh& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, {Reduction::grid});
}
Built build_hubbard(const Mesh& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, {Reduction::hubbard});
}
Built build_spawn(const Mesh& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, {Reduction::spawn});
}
Built build_medial(const Mesh& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers, chosen_or(run, {Reduction::merge, Reduction::expand}));
}
Built build_combined(const Mesh& mesh, const BuildRun& run, Workers& workers) {
  return build_reduced(mesh, run, workers,
                       chosen_or(run, {Reduction::grid, Reduction::spawn, Reduction::merge, Reduction::expand}));
}

}  // namespace morula
