// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Reports of trees and measurements that several commands print, as tables and as JSON.
#pragma once

#include <morula/accuracy/measure.hpp>
#include <morula/geometry/inspect.hpp>
#include <morula/tree/cover.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace morula::cli {

/// Keys stay in the order they were written in.
using Json = nlohmann::ordered_json;

/// Names of files need not be text in UTF-8: what is not is replaced.
std::string json_text(const Json& json, int indent);
/// One document on stdout, with a line break.
void print_json(const Json& json);

struct LevelSummary {
  std::size_t nodes = 0;
  std::size_t leaves = 0;
  double largest_radius = 0;
  double mean_radius = 0;
};
LevelSummary summary(const SphereTree& tree, std::size_t level);

/// Per level: nodes, leaves, largest and mean radius.
std::string level_table(const SphereTree& tree);
Json level_json(const SphereTree& tree);

/// The growth that made a tree without a cover cover the mesh; one line when there was none.
std::string growth_text(const BuildReport& report);
Json growth_json(const BuildReport& report);

/// The reason why an open mesh is open: "4 boundary edges".
std::string why_open(const MeshReport& report);
/// Why looseness or protrusion cannot be answered on this mesh; empty when they can.
std::string why_no_inside(const MeshReport& report);
/// "bunny.obj: 1234 vertices, 2464 facets".
std::string mesh_line(const std::string& name, const Mesh& mesh);

Json looseness_json(const Looseness& looseness);
Json coverage_json(const Coverage& coverage);
Json level_measure_json(const LevelMeasure& level);
/// A figure, or n/a.
std::string figure_or_na(const std::optional<double>& value);
std::string percent_or_na(const std::optional<double>& value);

}  // namespace morula::cli
