// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenarios self, proximity and swept: pairs of features of one body that is folded or poked until it goes through
// itself. Times are those of an update of the surface tree and of the query, together.
#include <algorithm>
#include <array>
#include <cmath>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <morula/tree/cover.hpp>
#include <numbers>

#include "frames.hpp"
#include "peers.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

/// A dent that goes through the body, and out again, in 25 frames.
std::vector<Frame> poke_and_back(const Mesh& mesh) {
  std::vector<Frame> frames;
  for (const double t : frame_parameters(25)) {
    Frame frame;
    for (const Vec3& p : deform(mesh, {Poke{.push = {0, 0, -0.5}, .radius = 0.5}}, t)) frame.emplace_back(p);
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Its longest axis becomes a curve whose heading swings from side to side, until it meets itself: flat ones like a
/// river, others like a hairpin. 25 frames, the last of them folded.
std::vector<Frame> folded(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  const Vec3 size = box.upper - box.lower, middle = 0.5 * (box.lower + box.upper);
  int along = 0, across = 0;
  for (int k = 1; k < 3; ++k) {
    if (size[k] > size[along]) along = k;
    if (size[k] <= size[across]) across = k;
  }
  const bool is_flat = size[across] < 0.05 * size[along];
  const double swings = is_flat ? 3 : 0.5, widest = is_flat ? 2.2 : 2.6;
  constexpr std::size_t steps = 4096;
  std::vector<Frame> frames;
  for (int f = 1; f <= 25; ++f) {
    const auto heading = [&](double u) {
      return widest * f / 25 * std::sin(2 * std::numbers::pi * swings * (u - 0.5));
    };
    std::vector<std::array<double, 2>> curve(steps + 1);
    for (std::size_t i = 0; i < steps; ++i) {
      const double angle = heading((static_cast<double>(i) + 0.5) / steps), step = size[along] / steps;
      curve[i + 1] = {curve[i][0] + step * std::cos(angle), curve[i][1] + step * std::sin(angle)};
    }
    Frame frame;
    for (Vec3 p : mesh.positions) {
      const double u = (p[along] - box.lower[along]) / size[along], height = p[across] - middle[across];
      const std::size_t i = std::min(static_cast<std::size_t>(u * steps), steps - 1);
      const double angle = heading(u), share = u * steps - static_cast<double>(i);
      p[along] = curve[i][0] + share * (curve[i + 1][0] - curve[i][0]) - height * std::sin(angle);
      p[across] = curve[i][1] + share * (curve[i + 1][1] - curve[i][1]) + height * std::cos(angle);
      frame.emplace_back(p);
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Brute force takes seconds on bodies of this size.
constexpr std::size_t most_facets_by_force = 6000;

/// Every pair of a vertex and a facet, and of two edges, without a common vertex, that a verdict keeps.
template <class Near>
std::vector<FeaturePair> by_force(const SurfaceTree& tree, const Near& near) {
  std::vector<FeaturePair> found;
  std::vector<std::uint8_t> used(tree.vertex_count());
  for (const Facet& f : tree.facets())
    for (const std::uint32_t v : f) used[v] = 1;
  const auto has = [](const Facet& f, std::uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; };
  for (std::uint32_t v = 0; v < tree.vertex_count(); ++v)
    for (std::uint32_t f = 0; used[v] != 0 && f < tree.facets().size(); ++f)
      if (const FeaturePair pair{PairKind::vertex_facet, v, f}; !has(tree.facets()[f], v) && near(pair))
        found.push_back(pair);
  for (std::uint32_t e = 0; e < tree.edges().size(); ++e)
    for (std::uint32_t g = e + 1; g < tree.edges().size(); ++g) {
      const auto &a = tree.edges()[e], &b = tree.edges()[g];
      const FeaturePair pair{PairKind::edge_edge, e, g};
      if (a[0] != b[0] && a[0] != b[1] && a[1] != b[0] && a[1] != b[1] && near(pair)) found.push_back(pair);
    }
  return found;
}

struct Corners {
  std::array<Vec3, 3> from, to;
  std::size_t size;
  Box box;
  Corners(const SurfaceTree& tree, bool is_vertex, bool is_edge, std::uint32_t number) {
    const auto take = [&](std::span<const std::uint32_t> vertices) {
      size = vertices.size();
      for (std::size_t i = 0; i < size; ++i) {
        box.add(from[i] = tree.from(vertices[i]));
        box.add(to[i] = tree.to(vertices[i]));
      }
    };
    if (is_vertex) {
      take(std::array{number});
    } else if (is_edge) {
      take(tree.edges()[number]);
    } else {
      take(tree.facets()[number]);
    }
  }
};
bool are_apart(const Box& a, const Box& b, double by) {
  for (int k = 0; k < 3; ++k)
    if (a.lower[k] > b.upper[k] + by || b.lower[k] > a.upper[k] + by) return true;
  return false;
}

template <class Pairs>
bool same_pairs(const std::vector<FeaturePair>& expected, const Pairs& found) {
  return std::equal(expected.begin(), expected.end(), found.begin(), found.end(),
                    [](const FeaturePair& a, const FeaturePair& b) { return a == b; });
}

std::vector<Result> crossings_with_itself(const Input& input, const Settings& settings, const std::string& motion,
                                          const std::vector<Frame>& frames) {
  SurfaceTree tree(input.mesh);
  SurfaceCrossingQuery query;
  Result own{.scenario = "self", .item = motion + ", surface tree", .mesh = input.name};
  Result embree{.scenario = "self", .item = motion + ", Embree and our test", .mesh = input.name};
  const std::unique_ptr<CrossingPeer> peer = make_self_crossing_peer(input.mesh);
  if (!peer) embree.note = "peer not built: install libembree-dev";
  bool same = true;
  double pairs = 0;
  std::vector<std::uint64_t> theirs, ours;
  timed(settings, [&] {
    for (const Frame& frame : frames) {
      own.seconds.push_back(
          processor_seconds_of([&] { require(tree.update(frame)), require(query.run(tree, *settings.workers)); }));
      pairs += static_cast<double>(query.pairs().size());
      if (!peer) continue;
      theirs.clear();
      embree.seconds.push_back(processor_seconds_of([&] { peer->take(frame, frame), peer->find(theirs); }));
      std::sort(theirs.begin(), theirs.end());
      theirs.erase(std::unique(theirs.begin(), theirs.end()), theirs.end());
      ours.clear();
      for (const FeaturePair& pair : query.pairs()) ours.push_back(std::uint64_t{pair.a} << 32 | pair.b);
      same = same && ours == theirs;
    }
  });
  own.expect(same, "not the pairs that Embree's boxes find with our test");
  own.figures = {{"pairs", pairs / static_cast<double>(own.seconds.size())}};
  if (peer) embree.figures = {{"times ours", median(embree.seconds) / median(own.seconds)}};
  return {own, embree};
}

/// Boxes of everything, with vertices in the order of the leaves of an octree and in the file's; and Embree's quickest
/// builder in every frame.
std::vector<Result> updates_of_everything(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, {.method = Method::octree, .depth = 4}, *settings.workers);
  const Mesh ordered = renumbered(input.mesh, leaf_order(model));
  const std::vector<Frame> frames = poke_and_back(ordered), file_frames = poke_and_back(input.mesh);
  SurfaceTree tree(ordered), again(ordered), file(input.mesh);
  const std::unique_ptr<Peer> peer = make_embree_rebuilt(input.mesh);
  Result own{.scenario = "self", .item = "update of all boxes", .mesh = input.name};
  Result embree{.scenario = "self", .item = "Embree, rebuilt", .mesh = input.name};
  if (!peer) embree.note = "peer not built: install libembree-dev";
  std::vector<double> file_seconds;
  bool same = true, contained = true;
  timed(settings, [&] {
    for (std::size_t f = 0; f < frames.size(); ++f) {
      own.seconds.push_back(processor_seconds_of([&] { require(tree.update(frames[f])); }));
      file_seconds.push_back(processor_seconds_of([&] { require(file.update(file_frames[f])); }));
      if (peer) {
        peer->take(file_frames[f]);
        embree.seconds.push_back(processor_seconds_of([&] { peer->refit(); }));
      }
      if (f % 8 != 0) continue;
      require(again.update(frames[frames.size() - 1 - f]));
      require(again.update(frames[f]));
      same = same && again.hash() == tree.hash();
      contained = contained && (!peer || peer->contains_facets());
    }
  });
  own.expect(same, "other boxes than after another frame");
  embree.expect(contained, "boxes without their facets");
  const auto per_vertex = [&](const std::vector<double>& seconds) {
    return 1e9 * median(seconds) / static_cast<double>(input.mesh.vertex_count());
  };
  own.figures = {{"ns/vertex, leaf order", per_vertex(own.seconds)}, {"file order", per_vertex(file_seconds)}};
  if (peer) embree.figures = {{"times ours", median(embree.seconds) / median(own.seconds)}};
  return {own, embree};
}

}  // namespace

std::vector<Result> run_self(const Input& input, const Settings& settings) {
  std::vector<Result> results = crossings_with_itself(input, settings, "folded", folded(input.mesh));
  const Box box = bounding_box(input.mesh);
  // A flat one cannot be poked through itself.
  if (box.upper.x > box.lower.x && box.upper.y > box.lower.y && box.upper.z > box.lower.z)
    for (Result& result : crossings_with_itself(input, settings, "poked", poke_and_back(input.mesh)))
      results.push_back(std::move(result));
  double pairs = 0;
  for (const Result& result : results)
    for (const auto& [name, value] : result.figures) pairs += name == "pairs" ? value : 0;
  results.front().expect(pairs > 0, "the body never crosses itself: take one that can be folded");
  for (Result& result : updates_of_everything(input, settings)) results.push_back(std::move(result));
  return results;
}

std::vector<Result> run_proximity(const Input& input, const Settings& settings) {
  const std::vector<Frame> frames = poke_and_back(input.mesh);
  const double distance = 0.004 * bounding_box(input.mesh).diagonal();
  SurfaceTree tree(input.mesh);
  ProximityQuery query({.distance = distance, .filter = {.rings = 1}}), all({.distance = distance});
  Result own{.scenario = "proximity", .item = "surface tree", .mesh = input.name};
  double pairs = 0, candidates = 0;
  timed(settings, [&] {
    for (const Frame& frame : frames) {
      own.seconds.push_back(processor_seconds_of([&] {
        require(tree.update(frame));
        const SurfaceQueryStatus status = query.run(tree, *settings.workers);
        require(status);
        candidates += static_cast<double>(status.candidates);
      }));
      pairs += static_cast<double>(query.pairs().size());
    }
  });
  if (input.mesh.facet_count() <= most_facets_by_force) {
    require(tree.update(frames[12]));
    require(all.run(tree));
    // Slabs between nearest points bound the distance from below by other arithmetic.
    const std::vector<FeaturePair> expected = by_force(tree, [&](const FeaturePair& pair) {
      const bool edges = pair.kind == PairKind::edge_edge;
      const Corners a(tree, !edges, edges, pair.a), b(tree, false, edges, pair.b);
      if (are_apart(a.box, b.box, distance)) return false;
      return !(time_of_impact(std::span(a.from).first(a.size), std::span(a.from).first(a.size),
                              std::span(b.from).first(b.size), std::span(b.from).first(b.size), distance) > 1);
    });
    own.expect(same_pairs(expected, all.pairs()), "not the pairs of brute force");
    own.expect(!expected.empty(), "nothing is near");
  }
  own.figures = {{"pairs", pairs / static_cast<double>(own.seconds.size())},
                 {"candidates", candidates / static_cast<double>(own.seconds.size())}};
  return {own};
}

std::vector<Result> run_swept(const Input& input, const Settings& settings) {
  const std::vector<Frame> frames = poke_and_back(input.mesh);
  SurfaceTree tree(input.mesh);
  SweptQuery candidates({.candidates_only = true}), query;
  Result boxes{.scenario = "swept", .item = "candidates", .mesh = input.name};
  Result impacts{.scenario = "swept", .item = "impacts", .mesh = input.name};
  double near = 0, pairs = 0;
  timed(settings, [&] {
    for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
      const double updating = processor_seconds_of([&] { require(tree.update(frames[f], frames[f + 1])); });
      boxes.seconds.push_back(updating +
                              processor_seconds_of([&] { require(candidates.run(tree, *settings.workers)); }));
      impacts.seconds.push_back(updating + processor_seconds_of([&] { require(query.run(tree, *settings.workers)); }));
      near += static_cast<double>(candidates.candidates().size());
      pairs += static_cast<double>(query.pairs().size());
    }
  });
  if (input.mesh.facet_count() <= most_facets_by_force) {
    require(tree.update(frames[11], frames[12]));
    require(query.run(tree));
    const std::vector<FeaturePair> expected = by_force(tree, [&](const FeaturePair& pair) {
      const bool edges = pair.kind == PairKind::edge_edge;
      const Corners a(tree, !edges, edges, pair.a), b(tree, false, edges, pair.b);
      if (are_apart(a.box, b.box, 0)) return false;
      return !(time_of_impact(std::span(a.from).first(a.size), std::span(a.to).first(a.size),
                              std::span(b.from).first(b.size), std::span(b.to).first(b.size)) > 1);
    });
    impacts.expect(same_pairs(expected, query.pairs()), "not the pairs of brute force");
    impacts.expect(!expected.empty(), "nothing meets");
  }
  boxes.figures = {{"pairs", near / static_cast<double>(boxes.seconds.size())}};
  impacts.figures = {{"pairs", pairs / static_cast<double>(impacts.seconds.size())}};
  return {boxes, impacts};
}

}  // namespace morula::bench
