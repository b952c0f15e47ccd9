// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Patch report: what `morula collide --patches` prints and writes of contact patches and of layer patches.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <morula/geometry/vector.hpp>
#include <string>
#include <toolbox/csv.hpp>
#include <utility>
#include <vector>

#include "commands/collide/report.hpp"
#include "shared/figures.hpp"
#include "shared/report.hpp"
#include "shared/table.hpp"

namespace morula::cli {

/// Everything that is printed and written, frame by frame: patches are valid until the next run only.
struct PatchReport {
  Table table{{"frame of A", "frame of B", "patch", "volume", "depth", "mean depth", "normal", "centroid", "points"},
              2};
  std::string rows =
      "frame_a,frame_b,patch,volume,depth,mean_depth,normal_x,normal_y,normal_z,centroid_x,centroid_y,centroid_z,"
      "area_a,area_b,force_x,force_y,force_z,points\n";
  Json frames = Json::array();
  std::vector<double> microseconds;
  std::size_t with_patches = 0;

  /// Adds the patches of a query. details: further members of the frame in JSON.
  template <class Query>
  void add(const std::string& name_a, const std::string& name_b, const Query& query, double frame_microseconds,
           const Json& details = Json::object());
  /// The table, and a line about all frames.
  std::string text() const;
};

std::string patch_vector_text(const Vec3& v);

template <class Side>
Json patch_side_json(const Side& side) {
  return {{"area", side.area},
          {"area_vector", vec3_json(side.area_vector)},
          {"moment", vec3_json(side.moment)},
          {"facets", side.facets.size()}};
}

/// Of a ContactPatch or LayerPatch.
template <class Patch>
Json patch_json(const Patch& p) {
  Json json{{"id", p.id},
            {"volume", p.volume},
            {"depth", p.depth},
            {"mean_depth", p.mean_depth},
            {"normal", vec3_json(p.normal)},
            {"centroid", vec3_json(p.centroid)},
            {"a", patch_side_json(p.a)},
            {"b", patch_side_json(p.b)},
            {"points", Json::array()}};
  if constexpr (requires { p.crossing_count; }) json["crossing_count"] = p.crossing_count;
  for (const auto& point : p.points)
    json["points"].push_back({{"id", point.id},
                              {"point", vec3_json(point.point)},
                              {"force", vec3_json(point.force)},
                              {"volume", point.volume},
                              {"depth", point.depth},
                              {"on_a", surface_point_json(point.on_a)},
                              {"on_b", surface_point_json(point.on_b)}});
  return json;
}

template <class Query>
void PatchReport::add(const std::string& name_a, const std::string& name_b, const Query& query,
                      double frame_microseconds, const Json& details) {
  microseconds.push_back(frame_microseconds);
  Json frame{{"a", name_a},
             {"b", name_b},
             {"volume", query.volume()},
             {"microseconds", frame_microseconds},
             {"patches", Json::array()}};
  frame.update(details);
  for (const auto& p : query.patches()) {
    table.add({name_a, name_b, std::to_string(p.id), figure(p.volume), figure(p.depth), figure(p.mean_depth),
               patch_vector_text(p.normal), patch_vector_text(p.centroid), std::to_string(p.points.size())});
    fmt::format_to(std::back_inserter(rows), "{},{},{},{},{},{},{},{},{},{},{},{}\n", toolbox::csv_cell(name_a),
                   toolbox::csv_cell(name_b), p.id, exact_digits(p.volume), exact_digits(p.depth),
                   exact_digits(p.mean_depth), vec3_csv(p.normal), vec3_csv(p.centroid), exact_digits(p.a.area),
                   exact_digits(p.b.area), vec3_csv(-p.a.area_vector), p.points.size());
    frame["patches"].push_back(patch_json(p));
  }
  if (query.patches().empty()) table.add({name_a, name_b, "-", "0", "-", "-", "-", "-", "0"});
  frames.push_back(std::move(frame));
  with_patches += query.patches().empty() ? 0 : 1;
}

}  // namespace morula::cli
