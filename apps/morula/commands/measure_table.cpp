// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/measure_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

/// The columns that not every table has.
struct Columns {
  bool frame;
  bool protrusion;
};

void add_level(Table& table, const Columns& columns, const std::string& frame, const LevelMeasure& level) {
  std::vector<std::string> cells;
  if (columns.frame) cells.push_back(level.level == 0 ? frame : std::string());
  for (std::string cell :
       {std::to_string(level.level), std::to_string(level.spheres), figure_or_na(level.looseness.looseness),
        percent_or_na(level.looseness.missed_volume), percent(level.coverage.bare_area), figure(level.coverage.gap),
        std::string(level.coverage.covered ? "yes" : "no")}) {
    cells.push_back(std::move(cell));
  }
  if (columns.protrusion) {
    cells.push_back(level.protrusion ? figure(level.protrusion->worst) : "n/a");
    cells.push_back(level.protrusion ? figure(level.protrusion->mean) : "n/a");
  }
  table.add(std::move(cells));
}

}  // namespace

std::vector<LevelMeasure> worst_of(const std::vector<MeasuredFrame>& frames) {
  std::vector<LevelMeasure> worst;
  const auto raise = [](std::optional<double>& to, const std::optional<double>& by) {
    if (by) to = std::max(to.value_or(*by), *by);
  };
  for (const MeasuredFrame& frame : frames) {
    for (const LevelMeasure& level : frame.levels) {
      if (level.level >= worst.size()) {
        worst.push_back(level);
        continue;
      }
      LevelMeasure& w = worst[level.level];
      w.spheres = std::max(w.spheres, level.spheres);
      raise(w.looseness.looseness, level.looseness.looseness);
      raise(w.looseness.missed_volume, level.looseness.missed_volume);
      if (const auto& range = level.looseness.range) {
        const Looseness::Range known = w.looseness.range.value_or(*range);
        w.looseness.range = {std::max(known.low, range->low), std::max(known.high, range->high)};
      }
      w.coverage.covered = w.coverage.covered && level.coverage.covered;
      w.coverage.bare_area = std::max(w.coverage.bare_area, level.coverage.bare_area);
      w.coverage.gap = std::max(w.coverage.gap, level.coverage.gap);
      if (!level.protrusion) continue;
      if (!w.protrusion) w.protrusion = level.protrusion;
      w.protrusion->worst = std::max(w.protrusion->worst, level.protrusion->worst);
      w.protrusion->mean = std::max(w.protrusion->mean, level.protrusion->mean);
    }
  }
  return worst;
}

std::string measure_table(const std::vector<MeasuredFrame>& frames, const std::vector<LevelMeasure>& worst,
                          bool with_protrusion) {
  const Columns columns{.frame = frames.size() > 1, .protrusion = with_protrusion};
  std::vector<std::string> header{"level", "spheres", "looseness", "missed", "bare area", "gap", "covered"};
  if (columns.frame) header.insert(header.begin(), "frame");
  if (columns.protrusion) header.insert(header.end(), {"protrusion", "mean"});
  Table table(header, columns.frame ? 1 : 0);
  for (const MeasuredFrame& frame : frames) {
    for (const LevelMeasure& level : frame.levels) add_level(table, columns, frame.name, level);
  }
  if (columns.frame) {
    table.add_rule();
    for (const LevelMeasure& level : worst) add_level(table, columns, "worst", level);
  }
  return table.text();
}

std::string cover_sentence(const std::vector<LevelMeasure>& worst) {
  std::string bare;
  for (const LevelMeasure& level : worst) {
    if (level.coverage.covered) continue;
    bare += fmt::format("{}level {} leaves {} bare, up to {} away", bare.empty() ? "" : "; ", level.level,
                        percent(level.coverage.bare_area), figure(level.coverage.gap));
  }
  return bare.empty() ? "Covers: no surface is bare at any level." : fmt::format("Does not cover: {}.", bare);
}

Json frames_json(const std::vector<MeasuredFrame>& frames) {
  Json json = Json::array();
  for (const MeasuredFrame& frame : frames) {
    Json levels = Json::array();
    for (const LevelMeasure& level : frame.levels) levels.push_back(level_measure_json(level));
    json.push_back({{"frame", frame.name}, {"tree", frame.tree}, {"levels", levels}});
  }
  return json;
}

}  // namespace morula::cli
