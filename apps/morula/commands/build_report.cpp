// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/build_report.hpp"

#include <algorithm>
#include <morula/accuracy/looseness.hpp>
#include <morula/geometry/inspect.hpp>

#include "shared/figures.hpp"
#include "shared/plots.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

// Voxels along the longest side of a level's box: research/notes/builds-measured.md and the benchmarks compare on this
// lattice.
constexpr int voxels = 160;

void throw_if_stopped(const StopToken& stop) {
  if (stop.stop_requested()) throw BuildStopped();
}

/// A few spheres at a time, so that it can be stopped.
Protrusion stoppable_protrusion(const SignedDistance& object, const std::vector<Sphere>& spheres, const StopToken& stop,
                                Workers& workers) {
  constexpr std::size_t at_a_time = 128;
  constexpr double tolerance = 1e-2;
  Protrusion all;
  for (std::size_t begin = 0; begin < spheres.size(); begin += at_a_time) {
    throw_if_stopped(stop);
    const auto some = std::span(spheres).subspan(begin, std::min(at_a_time, spheres.size() - begin));
    const Protrusion part = protrusion(object, some, tolerance, workers);
    all.worst = std::max(all.worst, part.worst);
    all.mean += part.mean * static_cast<double>(some.size());
  }
  all.mean /= static_cast<double>(spheres.size());
  return all;
}

}  // namespace

std::vector<LevelFigures> measure_levels(const Mesh& mesh, const SphereTree& tree, const StopToken& stop,
                                         Workers& workers) {
  std::vector<LevelFigures> levels;
  std::optional<SignedDistance> object;
  if (inspect(mesh).has_volume()) object.emplace(mesh, workers);
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    throw_if_stopped(stop);
    const std::vector<Sphere> spheres = level_set_spheres(tree, level);
    LevelFigures& figures = levels.emplace_back();
    figures.spheres = spheres.size();
    if (!object) continue;
    figures.looseness = looseness(mesh, spheres, {.resolution = voxels}, workers).looseness;
    figures.protrusion = stoppable_protrusion(*object, spheres, stop, workers);
  }
  return levels;
}

std::string build_table(const SphereTree& tree, const BuildReport& report, const std::vector<LevelFigures>& figures) {
  std::vector<std::string> header{"level", "nodes", "leaves", "largest radius", "mean radius"};
  if (!figures.empty()) header.insert(header.end(), {"spheres", "looseness", "protrusion", "mean"});
  // Below the root, which is far larger and looser than all the rest.
  const bool draws_looseness = !figures.empty() && tree.level_count() > 1 && figures[1].looseness.has_value();
  header.insert(header.end(), {"seconds", draws_looseness ? "looseness below the root" : "mean radius below the root"});
  const auto drawn = [&](std::size_t level) {
    return draws_looseness ? figures[level].looseness.value_or(0) : summary(tree, level).mean_radius;
  };
  double largest = 0;
  for (std::size_t level = 1; level < tree.level_count(); ++level) largest = std::max(largest, drawn(level));
  Table table(header, 0, true);
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    const LevelSummary s = summary(tree, level);
    std::vector<std::string> row{std::to_string(level), std::to_string(s.nodes), std::to_string(s.leaves),
                                 figure(s.largest_radius), figure(s.mean_radius)};
    if (!figures.empty()) {
      const LevelFigures& f = figures[level];
      const auto of_protrusion = [&](double Protrusion::*which) {
        return f.protrusion ? figure((*f.protrusion).*which) : std::string("n/a");
      };
      row.insert(row.end(), {std::to_string(f.spheres), figure_or_na(f.looseness), of_protrusion(&Protrusion::worst),
                             of_protrusion(&Protrusion::mean)});
    }
    row.push_back(seconds(report.level_seconds[level]));
    row.push_back(level > 0 && largest > 0 ? bar(drawn(level) / largest, 24) : std::string());
    table.add(std::move(row));
  }
  return table.text();
}

Json build_levels_json(const SphereTree& tree, const BuildReport& report, const std::vector<LevelFigures>& figures) {
  Json levels = level_json(tree);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    if (!figures.empty()) {
      const LevelFigures& f = figures[level];
      levels[level]["spheres"] = f.spheres;
      levels[level]["looseness"] = f.looseness ? Json(*f.looseness) : Json(nullptr);
      levels[level]["protrusion_worst"] = f.protrusion ? Json(f.protrusion->worst) : Json(nullptr);
      levels[level]["protrusion_mean"] = f.protrusion ? Json(f.protrusion->mean) : Json(nullptr);
    }
    levels[level]["seconds"] = report.level_seconds[level];
  }
  return levels;
}

}  // namespace morula::cli
