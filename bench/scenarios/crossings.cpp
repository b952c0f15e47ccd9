// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario crossings: all pairs of facets that intersect, of a mesh and a copy of it turned by a right angle, while
// both bend; by sphere trees, by surface trees, and beside FCL, Bullet and Embree. Times are those of the queries
// alone; "with update" is the median with both bodies brought up to date.
#include <algorithm>
#include <iterator>
#include <morula/collide/crossings.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/tree/cover.hpp>
#include <morula/update/body.hpp>

#include "peers.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

struct Bending {
  Mesh mesh;
  CoveredTree model;
  Body body;
  Collider collider;
  std::vector<Frame> frames;

  Bending(const Mesh& unordered, const Settings& settings)
      : Bending(unordered, build(unordered, tree_options(settings), *settings.workers), settings) {}

 private:
  Bending(const Mesh& unordered, const CoveredTree& as_built, const Settings& settings)
      : Bending(renumbered(unordered, leaf_order(as_built)), as_built, leaf_order(as_built), settings) {}
  Bending(Mesh ordered, const CoveredTree& as_built, const std::vector<std::uint32_t>& order, const Settings& settings)
      : mesh(std::move(ordered)),
        model(renumbered(as_built, mesh, order)),
        body(mesh, model, {}, *settings.workers),
        collider(mesh, body) {}
};

/// A quarter turn about z, and so far along z that the upper third of one is in the lower third of the other.
Mesh turned(Mesh mesh) {
  const Box box = bounding_box(mesh);
  const Vec3 c = box.center();
  for (Vec3& p : mesh.positions) p = {c.x - (p.y - c.y), c.y + (p.x - c.x), p.z + 0.67 * box.extent().z};
  return mesh;
}

/// A bend out and back, `ahead` frames further than others.
std::vector<Frame> bends(const Mesh& mesh, std::size_t ahead) {
  std::vector<Frame> frames = bend_and_back(mesh);
  std::rotate(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(ahead), frames.end());
  return frames;
}

using PairKeys = std::vector<std::uint64_t>;

PairKeys pairs_of(const SurfaceCrossingQuery& found) {
  PairKeys pairs;
  for (const FeaturePair& pair : found.pairs()) pairs.push_back(std::uint64_t{pair.a} << 32 | pair.b);
  return pairs;
}

PairKeys pairs_of(const CrossingQuery& found) {
  PairKeys pairs;
  for (const Crossing& c : found.pairs()) pairs.push_back(std::uint64_t{c.facet_a} << 32 | c.facet_b);
  return pairs;
}

struct CrossingRival {
  const CrossingPeerKind* kind;
  std::unique_ptr<CrossingPeer> peer;
  Result result;
  std::vector<double> with_update{};
  std::size_t missed = 0, invented = 0;

  void compare(const PairKeys& ours, PairKeys theirs) {
    std::sort(theirs.begin(), theirs.end());
    theirs.erase(std::unique(theirs.begin(), theirs.end()), theirs.end());
    PairKeys difference;
    std::set_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(), std::back_inserter(difference));
    missed += difference.size();
    difference.clear();
    std::set_difference(theirs.begin(), theirs.end(), ours.begin(), ours.end(), std::back_inserter(difference));
    invented += difference.size();
  }
};

}  // namespace

std::vector<Result> run_crossings(const Input& input, const Settings& settings) {
  Bending a(input.mesh, settings), b(turned(input.mesh), settings);
  a.frames = bends(a.mesh, 0), b.frames = bends(b.mesh, 6);
  const auto move = [&](std::size_t f) {
    const bool moved = a.body.update(a.frames[f], *settings.workers) && b.body.update(b.frames[f], *settings.workers);
    a.collider.set_positions(a.frames[f]);
    b.collider.set_positions(b.frames[f]);
    return moved;
  };

  std::vector<CrossingRival> rivals;
  for (const CrossingPeerKind& kind : crossing_peer_kinds()) {
    CrossingRival rival{
        &kind, kind.make(a.mesh, b.mesh), {.scenario = "crossings", .item = kind.name, .mesh = input.name}};
    if (!rival.peer) rival.result.note = std::string("peer not built: install ") + kind.package;
    rivals.push_back(std::move(rival));
  }

  Result own{.scenario = "crossings", .item = "crossings", .mesh = input.name};
  std::vector<double> own_with_update;
  SurfaceTree tree_a(a.mesh), tree_b(b.mesh);
  SurfaceCrossingQuery of_trees;
  Result trees{.scenario = "crossings", .item = "surface trees", .mesh = input.name};
  std::vector<double> trees_with_update;
  bool same_of_trees = true;
  // The bodies' spheres every frame, and boxes where these are near each other.
  SurfaceTree deep_a(a.mesh), deep_b(b.mesh);
  SurfaceCrossingQuery of_deep;
  Result deep{.scenario = "crossings", .item = "surface trees that follow bodies", .mesh = input.name};
  std::vector<double> deep_with_update;
  bool same_of_deep = true;
  // Brute force on as many frames as a few seconds allow.
  const double facets = static_cast<double>(input.mesh.facet_count());
  const std::size_t checks = facets < 2000 ? 25 : facets < 10000 ? 3 : 0;
  CrossingQuery found;
  double pairs = 0, tested = 0, read = 0, leaf_pairs = 0;
  bool equal = true, moved = true;
  std::vector<PairKeys> expected;
  for (std::size_t f = 0; f < a.frames.size(); ++f) {
    moved = move(f) && moved;
    require(found.run(a.collider, b.collider));
    expected.push_back(pairs_of(found));
    if (f < checks) {
      const std::vector<Crossing> all = brute_force::crossings(a.collider, b.collider);
      equal = equal && std::equal(all.begin(), all.end(), found.pairs().begin(), found.pairs().end());
    }
    pairs += static_cast<double>(found.pairs().size());
    tested += static_cast<double>(found.pairs_tested());
    read += static_cast<double>(found.facets_read());
    leaf_pairs += static_cast<double>(found.leaf_pairs());
  }
  own.expect(equal, "not the pairs of brute force");

  bool same = true;
  PairKeys theirs;
  timed(settings, [&] {
    for (std::size_t f = 0; f < a.frames.size(); ++f) {
      const double moving = processor_seconds_of([&] { moved = move(f) && moved; });
      own.seconds.push_back(processor_seconds_of([&] { require(found.run(a.collider, b.collider)); }));
      own_with_update.push_back(moving + own.seconds.back());
      same = same && pairs_of(found) == expected[f];
      const double following = processor_seconds_of([&] {
        moved = move(f) && moved;
        same_of_deep = same_of_deep && deep_a.follow(a.collider) && deep_b.follow(b.collider);
      });
      deep.seconds.push_back(processor_seconds_of([&] { require(of_deep.run(deep_a, deep_b)); }));
      deep_with_update.push_back(following + deep.seconds.back());
      same_of_deep = same_of_deep && pairs_of(of_deep) == expected[f];
      const double updating =
          processor_seconds_of([&] { require(tree_a.update(a.frames[f])), require(tree_b.update(b.frames[f])); });
      trees.seconds.push_back(processor_seconds_of([&] { require(of_trees.run(tree_a, tree_b)); }));
      trees_with_update.push_back(updating + trees.seconds.back());
      same_of_trees = same_of_trees && pairs_of(of_trees) == expected[f];
      for (CrossingRival& rival : rivals) {
        if (!rival.peer) continue;
        const double taking = processor_seconds_of([&] { rival.peer->take(a.frames[f], b.frames[f]); });
        theirs.clear();
        rival.result.seconds.push_back(processor_seconds_of([&] { rival.peer->find(theirs); }));
        rival.with_update.push_back(taking + rival.result.seconds.back());
        rival.compare(expected[f], theirs);
      }
    }
  });
  own.expect(moved, "an update was rejected");
  own.expect(same, "other pairs in a repeated frame");
  trees.expect(same_of_trees, "not the pairs of the sphere trees");
  deep.expect(same_of_deep, "not the pairs of the sphere trees");

  const double frames = static_cast<double>(a.frames.size());
  own.figures = {{"pairs", pairs / frames},
                 {"tested", tested / frames},
                 {"facets read", read / frames},
                 {"leaf pairs", leaf_pairs / frames},
                 {"brute force on frames", static_cast<double>(std::min(checks, a.frames.size()))},
                 {"with update, us", 1e6 * median(own_with_update)}};
  trees.figures = {{"with update, us", 1e6 * median(trees_with_update)}};
  deep.figures = {{"with update, us", 1e6 * median(deep_with_update)}};
  std::vector<Result> results;
  for (CrossingRival& rival : rivals) {
    if (!rival.peer) continue;
    own.expect(!rival.kind->our_test || rival.invented == 0,
               std::string("missed pairs that were found by way of ") + rival.kind->name);
    rival.result.figures = {
        {"times ours", median(rival.result.seconds) / median(own.seconds)},
        {"pairs missed", static_cast<double>(rival.missed)},
        {"pairs invented", static_cast<double>(rival.invented)},
        {"with update, us", 1e6 * median(rival.with_update)},
        {"times surface trees", median(rival.result.seconds) / median(trees.seconds)},
        {"times surface trees with update", median(rival.with_update) / median(trees_with_update)},
        {"times those that follow with update", median(rival.with_update) / median(deep_with_update)}};
  }
  results.push_back(std::move(own));
  results.push_back(std::move(trees));
  results.push_back(std::move(deep));
  for (CrossingRival& rival : rivals) results.push_back(std::move(rival.result));
  return results;
}

}  // namespace morula::bench
