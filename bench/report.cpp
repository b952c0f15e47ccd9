// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/version.hpp>
#include <nlohmann/json.hpp>

namespace morula::bench {
namespace {

std::string duration(double seconds) {
  if (seconds < 1e-3) return fmt::format("{:.2f} us", 1e6 * seconds);
  if (seconds < 1) return fmt::format("{:.2f} ms", 1e3 * seconds);
  return fmt::format("{:.2f} s", seconds);
}

#ifdef __clang__
constexpr const char* compiler = "clang " __clang_version__;
#else
constexpr const char* compiler = "gcc " __VERSION__;
#endif

double least(const Result& result) {
  return *std::min_element(result.seconds.begin(), result.seconds.end());
}
double most(const Result& result) {
  return *std::max_element(result.seconds.begin(), result.seconds.end());
}

}  // namespace

void print(const Result& result) {
  if (result.seconds.empty())
    fmt::print("{:10}{:30}  {}\n", result.scenario, result.item, result.note);
  else
    fmt::print("{:<14} {:30}  min {:>10}  median {:>10}  worst {:>10}  of {}\n", result.scenario, result.item,
               duration(least(result)), duration(median(result.seconds)), duration(most(result)),
               result.seconds.size());
  std::string line;
  for (const Figure& figure : result.figures)
    line += fmt::format("{}{} {:.6g}", line.empty() ? "" : ", ", figure.name, figure.value);
  if (!line.empty()) fmt::print("{:8}{}\n", "", line);
  for (const std::string& fault : result.faults) fmt::print("{:8}WRONG: {}\n", "", fault);
}

void print(std::span<const SummaryRow> rows) {
  if (rows.empty()) return;
  fmt::print("over all meshes\n{:8}{:12}{:24}{:>7}{:>12}{:>12}\n", "", "method", "figure", "meshes", "median",
             "largest");
  for (const SummaryRow& row : rows)
    fmt::print("{:8}{:12}{:24}{:>7}{:>12.4g}{:>12.4g}\n", "", row.item, row.figure, row.meshes, row.median,
               row.largest);
}

std::string to_json(std::span<const Input> inputs, std::span<const Result> results, std::span<const SummaryRow> summary,
                    const Settings& settings) {
  using nlohmann::json;
  json meshes = json::array();
  for (const Input& input : inputs)
    meshes.push_back({{"name", input.name},
                      {"vertices", input.mesh.vertex_count()},
                      {"facets", input.mesh.facet_count()},
                      {"hash", fmt::format("{:016x}", mesh_hash(input.mesh))}});
  json rows = json::array();
  for (const Result& result : results) {
    json figures = json::object();
    for (const Figure& figure : result.figures) figures[figure.name] = figure.value;
    json row{{"scenario", result.scenario},      {"item", result.item},           {"mesh", result.mesh},
             {"repeats", result.seconds.size()}, {"figures", std::move(figures)}, {"faults", result.faults}};
    if (!result.note.empty()) row["note"] = result.note;
    if (!result.seconds.empty())
      row.update({{"min", least(result)}, {"median", median(result.seconds)}, {"worst", most(result)}});
    rows.push_back(std::move(row));
  }
  json over_meshes = json::array();
  for (const SummaryRow& row : summary)
    over_meshes.push_back({{"item", row.item},
                           {"figure", row.figure},
                           {"meshes", row.meshes},
                           {"median", row.median},
                           {"largest", row.largest}});
  const json report{
      {"morula", version},           {"compiler", compiler},       {"threads", settings.workers->thread_count()},
      {"meshes", std::move(meshes)}, {"results", std::move(rows)}, {"summary", std::move(over_meshes)}};
  return report.dump(2);
}

}  // namespace morula::bench
