// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario peers: a frame of `exact` beside a refit by other libraries, on the mesh and on the same mesh with every
// facet divided in four.
#include "peers.hpp"

#include <algorithm>
#include <map>
#include <morula/generators/build.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>
#include <optional>

#include "resources.hpp"

namespace morula::bench {
namespace {

/// Every facet divided in four by the middles of its edges.
Mesh divided(const Mesh& mesh) {
  Mesh fine{mesh.positions, {}};
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [found, is_new] = middles.emplace(std::minmax(a, b), static_cast<std::uint32_t>(fine.positions.size()));
    if (is_new) fine.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
    return found->second;
  };
  for (const auto& [a, b, c] : mesh.facets) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.facets.insert(fine.facets.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

struct Rival {
  const PeerKind* kind;
  std::unique_ptr<Peer> peer;
  Result result;
};

std::string item_name(const std::string& name, const Mesh& mesh) {
  return name + ", " + std::to_string(mesh.vertex_count());
}

std::vector<Rival> rivals(const std::string& mesh_name, const Mesh& mesh, const std::vector<Frame>& frames) {
  std::vector<Rival> made;
  for (const PeerKind& kind : peer_kinds()) {
    Rival rival{&kind, kind.make(mesh), {.scenario = "peers", .item = item_name(kind.name, mesh), .mesh = mesh_name}};
    if (!rival.peer) rival.result.note = std::string("peer not built: install ") + kind.package;
    bool contains = true;
    for (const Frame& frame : frames) {
      if (!rival.peer) break;
      rival.peer->take(frame);
      rival.peer->refit();
      contains = contains && rival.peer->contains_facets();
    }
    rival.result.expect(contains, "a facet outside the peer's boxes");
    made.push_back(std::move(rival));
  }
  return made;
}

Result exact_result(const std::string& mesh_name, const Mesh& mesh, Body& body, const std::vector<Frame>& frames) {
  Result result{.scenario = "peers", .item = item_name("exact", mesh), .mesh = mesh_name};
  std::vector<Sphere> spheres;
  bool covered = true;
  for (const Frame& frame : frames) {
    covered = covered && body.update(frame);
    body.copy_spheres(spheres);
    covered = covered && certify(body.cover(), frame, spheres).covered;
  }
  result.expect(covered, "surface outside the spheres");
  return result;
}

std::vector<Result> compare(const std::string& mesh_name, const Mesh& unordered, const Settings& settings) {
  const CoveredTree as_built = build(unordered, tree_options(settings), *settings.workers);
  // Neighbors lie together in memory, which helps everybody.
  const std::vector<std::uint32_t> order = leaf_order(as_built);
  const Mesh mesh = renumbered(unordered, order);
  const CoveredTree model = renumbered(as_built, mesh, order);
  const std::vector<Frame> frames = bend_and_back(mesh);
  Body body(mesh, model, {}, *settings.workers);
  Result exact = exact_result(mesh_name, mesh, body, frames);
  std::vector<Rival> others = rivals(mesh_name, mesh, frames);

  // All in turn, so that a machine that is busy for a while is busy for all of them.
  timed(settings, [&] {
    for (const Frame& frame : frames)
      exact.seconds.push_back(processor_seconds_of([&] { require(body.update(frame)); }));
    for (Rival& rival : others)
      for (const Frame& frame : frames) {
        if (!rival.peer) break;
        rival.peer->take(frame);
        rival.result.seconds.push_back(processor_seconds_of([&] { rival.peer->refit(); }));
      }
  });

  const double own = median(exact.seconds);
  std::optional<double> best;
  for (Rival& rival : others) {
    if (!rival.peer) continue;
    const double theirs = median(rival.result.seconds);
    best = std::min(best.value_or(theirs), theirs);
    rival.result.figures = {{"ns/vertex", nanoseconds_per_vertex(rival.result.seconds, mesh)},
                            {"times exact", theirs / own},
                            {"leaves", static_cast<double>(mesh.facet_count())}};
  }
  const UpdateStatus work = body.update(frames.front());
  require(work);
  exact.figures = {{"ns/vertex", nanoseconds_per_vertex(exact.seconds, mesh)},
                   {"spheres", static_cast<double>(model.tree.node_count())},
                   {"leaves", static_cast<double>(model.tree.leaf_count())},
                   {"cut points", static_cast<double>(work.cut_points_moved)}};
  if (best) exact.figures.push_back({"times faster than the best peer", *best / own});

  std::vector<Result> results{std::move(exact)};
  for (Rival& rival : others) results.push_back(std::move(rival.result));
  return results;
}

}  // namespace

std::vector<Result> run_peers(const Input& input, const Settings& settings) {
  std::vector<Result> results = compare(input.name, input.mesh, settings);
  for (Result& result : compare(input.name, divided(input.mesh), settings)) results.push_back(std::move(result));
  return results;
}

}  // namespace morula::bench
