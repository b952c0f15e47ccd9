// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

Json optional_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

LevelSummary summary(const SphereTree& tree, std::size_t level) {
  LevelSummary s;
  for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
    const double radius = tree.spheres[node].radius;
    ++s.nodes;
    s.leaves += tree.is_leaf(node) ? 1 : 0;
    s.largest_radius = std::max(s.largest_radius, radius);
    s.mean_radius += radius;
  }
  if (s.nodes > 0) s.mean_radius /= static_cast<double>(s.nodes);
  return s;
}

std::string json_text(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

void print_json(const Json& json) {
  fmt::print("{}\n", json_text(json, 2));
}

std::string level_table(const SphereTree& tree) {
  Table table({"level", "nodes", "leaves", "largest radius", "mean radius"}, 0);
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    const LevelSummary s = summary(tree, level);
    table.add({std::to_string(level), std::to_string(s.nodes), std::to_string(s.leaves), figure(s.largest_radius),
               figure(s.mean_radius)});
  }
  return table.text();
}

Json level_json(const SphereTree& tree) {
  Json levels = Json::array();
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    const LevelSummary s = summary(tree, level);
    levels.push_back({{"level", level},
                      {"nodes", s.nodes},
                      {"leaves", s.leaves},
                      {"largest_radius", s.largest_radius},
                      {"mean_radius", s.mean_radius}});
  }
  return levels;
}

std::string growth_text(const BuildReport& report) {
  const bool grown =
      std::any_of(report.growth.begin(), report.growth.end(), [](const LevelGrowth& g) { return g.grown > 0; });
  std::string text;
  if (report.dropped_spheres > 0) {
    text += fmt::format("{} owned no surface and were dropped.\n", counted(report.dropped_spheres, "sphere"));
  }
  if (!grown) return text + "The spheres cover the mesh as they are: nothing had to grow.\n";
  text += "Grown so that every level covers the mesh:\n";
  Table table({"level", "grown", "largest factor", "largest growth"}, 0);
  for (std::size_t level = 0; level < report.growth.size(); ++level) {
    const LevelGrowth& g = report.growth[level];
    table.add({std::to_string(level), std::to_string(g.grown), figure(g.largest_factor), figure(g.largest_growth)});
  }
  return text + table.text();
}

Json growth_json(const BuildReport& report) {
  Json levels = Json::array();
  for (std::size_t level = 0; level < report.growth.size(); ++level) {
    const LevelGrowth& g = report.growth[level];
    levels.push_back({{"level", level},
                      {"grown", g.grown},
                      {"largest_factor", g.largest_factor},
                      {"largest_growth", g.largest_growth}});
  }
  return {{"dropped_spheres", report.dropped_spheres}, {"levels", levels}};
}

std::string why_open(const MeshReport& report) {
  if (report.boundary_edges > 0) return counted(report.boundary_edges, "boundary edge");
  if (report.nonmanifold_edges == 0) return "no facet has edges";
  return "no boundary edge, but edges of an odd number of facets";
}

std::string why_no_inside(const MeshReport& report) {
  if (report.has_volume()) return {};
  if (!report.closed) return fmt::format("the mesh is open ({})", why_open(report));
  return fmt::format("facets of the mesh disagree on what is outside ({})",
                     counted(report.misoriented_edges, "misoriented edge"));
}

std::string mesh_line(const std::string& name, const Mesh& mesh) {
  return fmt::format("{}: {}, {}", name, counted(mesh.vertex_count(), "vertex", "vertices"),
                     counted(mesh.facet_count(), "facet"));
}

Json looseness_json(const Looseness& l) {
  Json json{{"looseness", optional_json(l.looseness)},
            {"missed_volume", optional_json(l.missed_volume)},
            {"outside_volume", l.looseness ? Json(l.outside_volume) : Json(nullptr)},
            {"object_volume", l.looseness ? Json(l.object_volume) : Json(nullptr)},
            {"union_volume", l.union_volume},
            {"voxels", l.voxels},
            {"voxel_edge", l.voxel_edge}};
  if (l.range) {
    json["inside"] = "winding number";
    json["looseness_low"] = l.range->low;
    json["looseness_high"] = l.range->high;
  }
  return json;
}

Json coverage_json(const Coverage& c) {
  return {{"covered", c.covered},
          {"uncovered_area", c.uncovered_area},
          {"uncovered_distance", c.uncovered_distance},
          {"uncovered_distance_upper", c.uncovered_distance_upper},
          {"tolerance", c.tolerance},
          {"worst_facet", c.worst_facet}};
}

Json level_measure_json(const LevelMeasure& level) {
  Json json{{"level", level.level}, {"spheres", level.spheres}};
  json.update(looseness_json(level.looseness));
  json.update(coverage_json(level.coverage));
  json["protrusion_worst"] = level.protrusion ? Json(level.protrusion->worst) : Json(nullptr);
  json["protrusion_mean"] = level.protrusion ? Json(level.protrusion->mean) : Json(nullptr);
  if (level.sampled) {
    // Under the names that cuRobo gives them.
    const SampledFit& s = *level.sampled;
    json["curobo"] = {{"coverage", optional_json(s.coverage)},
                      {"protrusion", optional_json(s.protrusion)},
                      {"protrusion_dist_mean", optional_json(s.protrusion_mean)},
                      {"protrusion_dist_p95", optional_json(s.protrusion_p95)},
                      {"protrusion_dist_max", optional_json(s.protrusion_max)},
                      {"surface_gap_mean", s.surface_gap_mean},
                      {"surface_gap_p95", s.surface_gap_p95},
                      {"max_uncovered_gap", s.surface_gap_max},
                      {"volume_ratio", optional_json(s.volume_ratio)}};
  }
  return json;
}

std::string figure_or_na(const std::optional<double>& value) {
  return value ? figure(*value) : "n/a";
}

std::string percent_or_na(const std::optional<double>& value) {
  return value ? percent(*value) : "n/a";
}

}  // namespace morula::cli
