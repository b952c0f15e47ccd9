// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Scenario measure: looseness, coverage and protrusion of a leaf level.
#include <algorithm>
#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <morula/deform/deformation.hpp>
#include <morula/generators/build.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/update/body.hpp>

#include "scenario.hpp"

namespace morula::bench {
namespace {

/// Times question(workers), an array of numbers, and expects the same numbers on every repeat and on one thread.
template <std::size_t count, class Question>
std::array<double, count> timed_numbers(const Question& question, const Settings& settings, Result& result) {
  const std::array<double, count> expected = question(serial_workers());
  bool same = true;
  result.seconds = timed(settings, [&] { same = question(*settings.workers) == expected && same; });
  result.expect(same, "other numbers than on one thread, or than before");
  return expected;
}

Result time_looseness(const Input& input, const std::vector<Sphere>& spheres, const Settings& settings) {
  Result result{.scenario = "measure", .item = "looseness", .mesh = input.name};
  const auto question = [&](Workers& workers) {
    const Looseness l = looseness(input.mesh, spheres, {}, workers);
    return std::array{l.looseness.value_or(-1.0), l.union_volume, static_cast<double>(l.voxels)};
  };
  const auto [loose, union_volume, voxels] = timed_numbers<3>(question, settings, result);
  result.expect(std::isfinite(loose) && union_volume > 0, "no volume");
  result.figures = {{"looseness", loose}, {"voxels", voxels}, {"ns/voxel", 1e9 * median(result.seconds) / voxels}};
  return result;
}

/// Share of the surface outside all spheres, from points.
double sampled_uncovered_area(const Mesh& mesh, const std::vector<Sphere>& spheres, std::size_t count) {
  std::size_t uncovered = 0;
  for (const SurfacePoint& sample : sample_surface(mesh, count))
    uncovered +=
        std::none_of(spheres.begin(), spheres.end(), [&](const Sphere& s) { return power(s, sample.point) <= 0; });
  return static_cast<double>(uncovered) / static_cast<double>(count);
}

Result time_coverage(std::string item, const Input& input, const Mesh& mesh, const std::vector<Sphere>& spheres,
                     bool must_cover, const Settings& settings) {
  Result result{.scenario = "measure", .item = std::move(item), .mesh = input.name};
  const auto question = [&](Workers& workers) {
    const Coverage c = coverage(mesh, spheres, workers);
    return std::array{c.covered ? 1.0 : 0.0, c.uncovered_area, c.uncovered_distance, c.uncovered_distance_upper};
  };
  const auto [covered, uncovered_area, uncovered_distance, uncovered_distance_upper] =
      timed_numbers<4>(question, settings, result);
  if (must_cover)
    result.expect(covered == 1 && uncovered_area == 0 && uncovered_distance == 0, "surface outside the spheres");
  result.expect(
      uncovered_distance <= uncovered_distance_upper && uncovered_distance_upper <= uncovered_distance * (1 + 2e-6),
      "the uncovered distance is not known to 1e-6");

  // Stratified points scatter less than independent ones: five of their deviations is a wide margin.
  constexpr std::size_t samples = 10000;
  const double sampled = sampled_uncovered_area(mesh, spheres, samples);
  const double deviation =
      std::sqrt(std::max(uncovered_area * (1 - uncovered_area), 1e-4) / static_cast<double>(samples));
  result.expect(std::abs(sampled - uncovered_area) <= 5 * deviation, "sampling finds another uncovered area");

  result.figures = {{"uncovered area", uncovered_area},
                    {"uncovered_distance", uncovered_distance},
                    {"us/facet", 1e6 * median(result.seconds) / static_cast<double>(mesh.facet_count())}};
  return result;
}

Result time_protrusion(const Input& input, const std::vector<Sphere>& spheres, const Settings& settings) {
  Result result{.scenario = "measure", .item = "protrusion", .mesh = input.name};
  const SignedDistance object(input.mesh);
  const auto question = [&](Workers& workers) {
    const Protrusion p = protrusion(object, spheres, 1e-2, workers);
    return std::array{p.worst, p.mean};
  };
  const auto [worst, mean] = timed_numbers<2>(question, settings, result);
  // What one distance can prove, and what the sphere that sticks out most shows.
  double bound = 0;
  for (const Sphere& s : spheres) bound = std::max(bound, object.protrusion_bound(s));
  result.expect(mean <= worst && worst <= bound * (1 + 1e-9), "more than the ball's radius and distance allow");
  result.figures = {{"worst", worst},
                    {"mean", mean},
                    {"us/sphere", 1e6 * median(result.seconds) / static_cast<double>(spheres.size())}};
  return result;
}

}  // namespace

std::vector<Result> run_measure(const Input& input, const Settings& settings) {
  const CoveredTree model = build(input.mesh, tree_options(settings), *settings.workers);
  const std::size_t leaf_level = model.tree.level_count() - 1;
  const std::vector<Sphere> spheres = level_set_spheres(model.tree, leaf_level);

  std::vector<Result> results;
  results.push_back(time_looseness(input, spheres, settings));
  results.push_back(time_coverage("coverage at rest", input, input.mesh, spheres, true, settings));

  // A rule that leaves surface uncovered: its area and distance have to be found.
  Mesh bent = input.mesh;
  bent.positions = deform(input.mesh, {Bend{90}}, 1.0);
  Body body(input.mesh, model, {.rules = {Rule::approach2}}, *settings.workers);
  require(body.update(bent.positions, *settings.workers));
  const std::vector<Sphere> moved = level_set_spheres(body.current_tree(), leaf_level);
  results.push_back(time_coverage("coverage bent, approach2", input, bent, moved, false, settings));

  if (inspect(input.mesh).has_volume()) results.push_back(time_protrusion(input, spheres, settings));
  return results;
}

}  // namespace morula::bench
