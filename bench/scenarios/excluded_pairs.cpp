// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario filters: queries of one surface with itself whose pairs of neighbors, or near at rest, are left out, beside
// the same queries without a filter. Times are those of the queries alone, warm; "first run" has the table made.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <morula/deform/deformation.hpp>
#include <morula/surface/proximity.hpp>
#include <morula/surface/surface_crossings.hpp>
#include <morula/surface/swept.hpp>
#include <morula/tree/cover.hpp>

#include "frames.hpp"
#include "resources.hpp"

namespace morula::bench {
namespace {

/// The vertices of a feature: one, two or three.
std::vector<std::uint32_t> vertices_of(const SurfaceTree& tree, PairKind kind, bool is_first, std::uint32_t number) {
  if (kind == PairKind::edge_edge) return {tree.edges()[number].begin(), tree.edges()[number].end()};
  if (kind == PairKind::vertex_facet && is_first) return {number};
  return {tree.facets()[number].begin(), tree.facets()[number].end()};
}

/// What a filter is to leave out, by other means than the library's: a search along edges for every first feature, and
/// slabs between the features at rest.
class Judge {
 public:
  Judge(const Mesh& mesh, const SurfaceTree& tree, const PairFilter& filter)
      : mesh_(mesh), tree_(tree), filter_(filter) {
    next_.resize(mesh.positions.size());
    for (const Facet& f : mesh.facets)
      for (std::size_t k = 0; k < 3; ++k) next_[f[k]].push_back(f[(k + 1) % 3]), next_[f[(k + 1) % 3]].push_back(f[k]);
  }
  bool accepts(const FeaturePair& pair) {
    const auto a = vertices_of(tree_, pair.kind, true, pair.a), b = vertices_of(tree_, pair.kind, false, pair.b);
    return !(filter_.rings > 0 && are_neighbors(a, b)) && !(filter_.rest_distance > 0 && are_near(a, b));
  }

 private:
  bool are_neighbors(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
    if (a != from_) {
      from_ = a, reached_ = a;
      for (std::uint32_t ring = 0; ring < filter_.rings; ++ring) {
        for (std::size_t i = 0, end = reached_.size(); i < end; ++i)
          for (const std::uint32_t v : next_[reached_[i]]) reached_.push_back(v);
        std::sort(reached_.begin(), reached_.end());
        reached_.erase(std::unique(reached_.begin(), reached_.end()), reached_.end());
      }
    }
    return std::any_of(b.begin(), b.end(),
                       [&](std::uint32_t v) { return std::binary_search(reached_.begin(), reached_.end(), v); });
  }
  bool are_near(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) const {
    if (a.size() == 3 && b.size() == 3) {
      const auto triangle = [&](const std::vector<std::uint32_t>& f) -> Triangle {
        return {mesh_.positions[f[0]], mesh_.positions[f[1]], mesh_.positions[f[2]]};
      };
      if (intersect(triangle(a), triangle(b))) return true;
      for (std::size_t i = 0; i < 3; ++i) {
        if (are_near({a[i]}, b) || are_near({b[i]}, a)) return true;
        for (std::size_t j = 0; j < 3; ++j)
          if (are_near({a[i], a[(i + 1) % 3]}, {b[j], b[(j + 1) % 3]})) return true;
      }
      return false;
    }
    std::array<Vec3, 3> p, q;
    for (std::size_t i = 0; i < a.size(); ++i) p[i] = mesh_.positions[a[i]];
    for (std::size_t i = 0; i < b.size(); ++i) q[i] = mesh_.positions[b[i]];
    const auto in_a = std::span(p).first(a.size()), in_b = std::span(q).first(b.size());
    return !(time_of_impact(in_a, in_a, in_b, in_b, filter_.rest_distance) > 1);
  }

  const Mesh& mesh_;
  const SurfaceTree& tree_;
  const PairFilter& filter_;
  std::vector<std::vector<std::uint32_t>> next_;
  std::vector<std::uint32_t> from_, reached_;
};

struct Filter {
  std::string name;
  PairFilter filter;
};

/// Query and its options are of one kind; `pairs` takes what it found.
template <class Query, class Options>
std::vector<Result> with_filters(const std::string& kind, const Input& input, const Settings& settings,
                                 const std::vector<Filter>& filters, const Options& plain_options,
                                 const std::function<void(SurfaceTree&)>& move) {
  const auto pairs_of = [](const Query& query) {
    std::vector<FeaturePair> pairs;
    for (const FeaturePair& pair : query.pairs()) pairs.push_back(pair);
    return pairs;
  };
  SurfaceTree tree(input.mesh);
  move(tree);
  Query plain(plain_options);
  std::vector<Result> results{{.scenario = "filters", .item = kind, .mesh = input.name}};
  timed(settings, [&] {
    results[0].seconds.push_back(processor_seconds_of([&] { require(plain.run(tree, *settings.workers)); }));
  });
  const std::vector<FeaturePair> all = pairs_of(plain);
  results[0].figures = {{"pairs", static_cast<double>(all.size())}};
  // A coarse body does not touch itself: filters then have nothing to leave out.
  if (all.empty()) {
    results[0].note = "nothing is near: take a finer body";
    return results;
  }
  for (const auto& [name, filter] : filters) {
    Result result{.scenario = "filters", .item = kind + ", " + name, .mesh = input.name};
    Options options = plain_options;
    options.filter = filter;
    Query query(options);
    const double first = processor_seconds_of([&] { require(query.run(tree, *settings.workers)); });
    timed(settings, [&] {
      result.seconds.push_back(processor_seconds_of([&] { require(query.run(tree, *settings.workers)); }));
    });
    Judge judge(input.mesh, tree, filter);
    std::vector<FeaturePair> expected;
    for (const FeaturePair& pair : all)
      if (judge.accepts(pair)) expected.push_back(pair);
    result.expect(pairs_of(query) == expected, "not the pairs that the filter keeps");
    result.figures = {{"pairs", static_cast<double>(expected.size())},
                      {"times without", median(result.seconds) / median(results[0].seconds)},
                      {"first run, ms", 1e3 * first}};
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace

std::vector<Result> run_filters(const Input& input, const Settings& settings) {
  const double diagonal = bounding_box(input.mesh).diagonal();
  const auto at = [&](double t) { return deform(input.mesh, {Poke{.push = {0, 0, -0.5}, .radius = 0.5}}, t); };
  const std::vector<Vec3> before = at(0.9), deepest = at(1), bent = deform(input.mesh, {Bend{20}}, 1.0);
  // Shares that are no whole parts of anything: no two features of a regular mesh are just so far apart.
  const std::vector<Filter> filters{{"rings 1", {.rings = 1}},
                                    {"rings 2", {.rings = 2}},
                                    {"rings 4", {.rings = 4}},
                                    {"rest 0.7 %", {.rest_distance = 0.00697 * diagonal}},
                                    {"rest 3 %", {.rest_distance = 0.02983 * diagonal}},
                                    {"rest 30 %", {.rest_distance = 0.29871 * diagonal}},
                                    {"rings 2, rest 3 %", {.rings = 2, .rest_distance = 0.02983 * diagonal}}};
  std::vector<Result> results;
  const auto add = [&](std::vector<Result>&& more) {
    for (Result& result : more) results.push_back(std::move(result));
  };
  const auto to_deepest = [&](SurfaceTree& tree) { require(tree.update(deepest)); };
  add(with_filters<SurfaceCrossingQuery>("crossings", input, settings, filters, SurfaceCrossingOptions{}, to_deepest));
  add(with_filters<ProximityQuery>("proximity", input, settings, filters,
                                   ProximityOptions{.distance = 0.004 * diagonal}, to_deepest));
  add(with_filters<SweptQuery>("swept", input, settings, filters, SweptOptions{},
                               [&](SurfaceTree& tree) { require(tree.update(before, deepest)); }));
  // A body that is bent a little: nearly all near pairs were near at rest, and the search leaves out their nodes.
  const std::vector<Filter> wide{{"rings 12", {.rings = 12}},
                                 {"rest 2.5 %", {.rest_distance = 0.02513 * diagonal}},
                                 {"rest 12 %", {.rest_distance = 0.11997 * diagonal}}};
  add(with_filters<ProximityQuery>("wide proximity", input, settings, wide,
                                   ProximityOptions{.distance = 0.02 * diagonal},
                                   [&](SurfaceTree& tree) { require(tree.update(bent)); }));
  return results;
}

}  // namespace morula::bench
