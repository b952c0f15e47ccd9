// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <morula/study/study.hpp>
#include <toolbox/csv.hpp>
#include <toolbox/numbers.hpp>

namespace morula::study {

using namespace toolbox;

namespace {

std::string digits(const std::optional<double>& value) {
  return value ? exact_digits(*value) : std::string();
}

std::string cell_text(const TableValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return csv_cell(*text);
  if (const auto* count = std::get_if<std::size_t>(&value)) return std::to_string(*count);
  if (const auto* number = std::get_if<double>(&value)) return exact_digits(*number);
  return {};
}

/// Empty for a tree without a seed.
std::string seed_cell(const Source& source) {
  return source.seed ? std::to_string(*source.seed) : std::string();
}

}  // namespace

std::string figure_csv(std::span<const Figure> group) {
  const std::vector<std::string>& names = group.front().x_names;
  std::string text = fmt::format("figure,series,role,{},y\n", names.empty() ? "sample" : "query");
  for (const Figure& figure : group) {
    for (const Series& s : figure.series) {
      for (std::size_t i = 0; i < s.x.size(); ++i) {
        text += fmt::format("{},{},{},{},{}\n", figure.id, csv_cell(s.name), name(s.role),
                            names.empty() ? exact_digits(s.x[i]) : csv_cell(names[static_cast<std::size_t>(s.x[i])]),
                            digits(s.y[i]));
      }
    }
  }
  return text;
}

std::string table_csv(const Table& table) {
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) text += (i == 0 ? "" : ",") + csv_cell(table.columns[i]);
  text += '\n';
  for (const std::vector<TableValue>& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + cell_text(row[i]);
    text += '\n';
  }
  return text;
}

std::string cells_csv(const Plan& plan, const Result& result) {
  std::string text =
      "body,method,motion,rule,sample,parameter,level,spheres,looseness,looseness_box,looseness_fixed,missed_volume,"
      "uncovered_area,uncovered_distance,protrusion_worst,protrusion_mean,returns_to_rest,seed,"
      "looseness_half_grid";
  for (const OwnMetric& metric : plan.metrics) text += "," + csv_cell(metric.name);
  text += '\n';
  for (const std::vector<MotionRun>* list : {&result.cells, &result.mixes}) {
    const std::vector<FollowRule>& rules = list == &result.cells ? plan.rules : plan.mixes;
    for (const MotionRun& c : *list) {
      for (const Sample& s : c.samples) {
        for (const LevelFigures& l : s.levels) {
          text += fmt::format(
              "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}", csv_cell(plan.body_of(c.key.source).name),
              csv_cell(plan.sources[c.key.source].method), csv_cell(plan.motion_name(c.key.motion)),
              csv_cell(rules[c.key.rule].name), s.sample, exact_digits(s.parameter), l.level, l.spheres,
              digits(l.looseness()), digits(l.looseness_box()), digits(l.looseness_fixed()), digits(l.missed_volume()),
              exact_digits(l.uncovered_area()), exact_digits(l.uncovered_distance()), digits(l.protrusion_worst()),
              digits(l.protrusion_mean()), c.returns_to_rest ? (*c.returns_to_rest ? "yes" : "no") : "",
              seed_cell(plan.sources[c.key.source]), digits(l.error_on_half_grid(ErrorUnit::volume)));
          for (std::size_t i = 0; i < plan.metrics.size(); ++i)
            text += "," + (i < l.metrics.size() ? digits(l.metrics[i]) : std::string());
          text += '\n';
        }
      }
    }
  }
  return text;
}

}  // namespace morula::study
