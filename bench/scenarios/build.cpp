// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario build: every generator: time, looseness, and whether it keeps its promises.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <morula/accuracy/looseness.hpp>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/sample_bodies.hpp>

#include "baseline.hpp"
#include "resources.hpp"
#include "scenario.hpp"

namespace morula::bench {
namespace {

constexpr int voxels = 160;  // along the longest side of a level's box

struct LevelLooseness {
  std::size_t level;
  double value;
};
/// Of levels 1 and deeper; nothing on a mesh without volume.
std::vector<LevelLooseness> looseness_of(const Input& input, const SphereTree& tree, Workers& workers) {
  std::vector<LevelLooseness> levels;
  for (std::size_t level = 1; level < tree.level_count(); ++level)
    if (const auto loose =
            looseness(input.mesh, level_set_spheres(tree, level), {.resolution = voxels}, workers).looseness)
      levels.push_back({level, *loose});
  return levels;
}

void verify(const Input& input, const CoveredTree& model, Workers& workers, Result& result) {
  for (const std::string& fault : validate(input.mesh, model)) result.faults.push_back(fault);
  const Certificate certificate = certify(model.cover, input.mesh.positions, model.tree.spheres, workers);
  result.expect(certificate.covered, "surface outside the spheres");
  for (std::size_t level = 0; level < model.tree.level_count(); ++level) {
    const Coverage c = coverage(input.mesh, level_set_spheres(model.tree, level), workers);
    result.expect(c.covered && c.uncovered_area == 0, fmt::format("level {} leaves surface uncovered", level));
  }
}

/// Looseness, and its ratio to that of the baseline's same method and of its best.
void add_looseness(const Input& input, const Result& of, const std::vector<LevelLooseness>& levels,
                   const Baseline* baseline, std::vector<Figure>& figures) {
  for (const auto& [level, value] : levels) figures.push_back({fmt::format("looseness {}", level), value});
  if (!baseline) return;
  for (const auto& [level, value] : levels) {
    if (const auto same = baseline->same_method(input.name, of.item, level))
      figures.push_back({fmt::format("looseness {} / same", level), value / *same});
    if (const auto best = baseline->best(input.name, level))
      figures.push_back({fmt::format("looseness {} / best", level), value / *best});
  }
}

/// (largest − smallest) / median over seeds, per level.
void add_spread(const Input& input, BuildOptions options, const std::vector<LevelLooseness>& first,
                const Settings& settings, std::vector<Figure>& figures) {
  std::vector<std::vector<double>> values;
  for (const LevelLooseness& l : first) values.push_back({l.value});
  for (std::uint64_t k = 1; k < settings.seeds; ++k) {
    ++options.seed;
    const CoveredTree model = build(input.mesh, options, *settings.workers);
    for (const auto& [level, value] : looseness_of(input, model.tree, *settings.workers))
      if (level <= values.size()) values[level - 1].push_back(value);
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto [least, most] = std::minmax_element(values[i].begin(), values[i].end());
    figures.push_back({fmt::format("spread {}", i + 1), (*most - *least) / median(values[i])});
  }
}

/// So many spheres as one flat set, beside one level of as many children and the level of a tree.
Result flat_set_of(const Input& input, BuildOptions options, std::size_t spheres, const Settings& settings) {
  Result result{.scenario = "build",
                .item = fmt::format("{}{}, {} spheres", name(options.method),
                                    options.quality == Quality::fast ? " fast" : "", spheres),
                .mesh = input.name};
  options.spheres = spheres;
  CoveredTree flat;
  double user = std::numeric_limits<double>::infinity();
  result.seconds = timed(settings, [&] {
    const double before = user_seconds();
    flat = build(input.mesh, options, *settings.workers);
    user = std::min(user, user_seconds() - before);
  });
  verify(input, flat, *settings.workers, result);
  const auto loose = [&](const CoveredTree& model, std::size_t level) {
    const VoxelGrid grid{.kind = VoxelGrid::Kind::fixed, .voxel_edge = bounding_box(input.mesh).diagonal() / 256};
    return looseness(input.mesh, level_set_spheres(model.tree, level), grid, *settings.workers).looseness;
  };
  result.figures = {{"spheres", static_cast<double>(flat.tree.leaf_count())}, {"user s", user}};
  const auto own = loose(flat, flat.tree.level_count() - 1);
  if (!own) return result;
  result.figures.push_back({"looseness", *own});
  options.spheres.reset();
  options.branching = static_cast<int>(spheres);
  options.depth = 1;
  const CoveredTree one_level = build(input.mesh, options, *settings.workers);
  result.figures.push_back({"over one level", *own / *loose(one_level, one_level.tree.level_count() - 1)});
  options.branching = 8;
  options.depth = 2;
  const CoveredTree levels = build(input.mesh, options, *settings.workers);
  result.figures.push_back({"over level 2", *own / *loose(levels, levels.tree.level_count() - 1)});
  return result;
}

}  // namespace

std::vector<Result> run_build(const Input& input, const Settings& settings) {
  std::vector<Result> results;
  for (const Method method : settings.methods) {
    Result result{.scenario = "build", .item = std::string(name(method)), .mesh = input.name};
    const BuildOptions options{.method = method, .branching = 8, .depth = settings.depth};

    CoveredTree model;
    double user = std::numeric_limits<double>::infinity();
    result.seconds = timed(settings, [&] {
      const double before = user_seconds();
      model = build(input.mesh, options, *settings.workers);
      user = std::min(user, user_seconds() - before);
    });
    // Once more with another number of threads: the same tree, and what the threads gain.
    const bool on_one = settings.workers->thread_count() == 1;
    Workers others(on_one ? 2u : 1u);
    SphereTree again;
    const double others_seconds = seconds_of([&] { again = build(input.mesh, options, others).tree; });
    const double seconds = *std::min_element(result.seconds.begin(), result.seconds.end());
    result.expect(tree_hash(model.tree) == tree_hash(again), "another tree with another number of threads");
    verify(input, model, *settings.workers, result);

    result.figures = {{"spheres", static_cast<double>(model.tree.node_count())},
                      {"leaves", static_cast<double>(model.tree.leaf_count())},
                      {"patches", static_cast<double>(model.cover.patch_count())},
                      {"cut points", static_cast<double>(model.cover.cut_points.size())},
                      {"user s", user},
                      {"us/facet", 1e6 * median(result.seconds) / static_cast<double>(input.mesh.facet_count())},
                      {fmt::format("{} threads gain", on_one ? 2 : settings.workers->thread_count()),
                       on_one ? seconds / others_seconds : others_seconds / seconds}};
    const std::vector<LevelLooseness> levels = looseness_of(input, model.tree, *settings.workers);
    add_looseness(input, result, levels, settings.baseline, result.figures);
    if (settings.seeds > 1) add_spread(input, options, levels, settings, result.figures);
    results.push_back(std::move(result));
    constexpr std::size_t flat_spheres = 64;
    results.push_back(flat_set_of(input, {.method = method}, flat_spheres, settings));
    if (method == Method::optimized)
      results.push_back(flat_set_of(input, {.method = method, .quality = Quality::fast}, flat_spheres, settings));
  }
  return results;
}

std::vector<Result> run_build_scaling(const Settings& settings) {
  std::vector<Result> results;
  for (const Method method : settings.methods) {
    struct Measured {
      double facets, seconds, bytes;
    };
    std::vector<Measured> measured;
    for (const int facets : {10'000, 30'000, 100'000, 300'000, 1'000'000}) {
      // A blob has 1.7 × resolution² facets.
      const int resolution = static_cast<int>(std::lround(std::sqrt(facets / 1.7)));
      const Input input{fmt::format("blob:{}", resolution), sample_body("blob", resolution)};
      const double count = static_cast<double>(input.mesh.facet_count());
      Result result{.scenario = "build",
                    .item = fmt::format("{} of {}", name(method), input.mesh.facet_count()),
                    .mesh = input.name};
      const PeakMemory memory;
      CoveredTree model;
      result.seconds = {seconds_of([&] { model = build(input.mesh, {.method = method}, *settings.workers); })};
      const std::optional<std::size_t> bytes = memory.bytes();
      result.expect(certify(model.cover, input.mesh.positions, model.tree.spheres, *settings.workers).covered,
                    "surface outside the spheres");
      result.figures = {{"us/facet", 1e6 * result.seconds[0] / count}};
      if (bytes) result.figures.push_back({"peak bytes/facet", static_cast<double>(*bytes) / count});
      // What a build costs whatever the mesh is not the facets'.
      measured.push_back({count, result.seconds[0], bytes ? static_cast<double>(*bytes) : 0.0});
      const Measured &least = measured.front(), &now = measured.back();
      if (measured.size() > 1) {
        const double more = now.facets - least.facets;
        result.figures.push_back({"us/facet beyond 10k", 1e6 * (now.seconds - least.seconds) / more});
        if (bytes) result.figures.push_back({"bytes/facet beyond 10k", (now.bytes - least.bytes) / more});
      }
      results.push_back(std::move(result));
    }
  }
  return results;
}

}  // namespace morula::bench
