// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/measure_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "shared/figures.hpp"
#include "shared/plots.hpp"
#include "shared/table.hpp"

namespace morula::cli {
namespace {

/// The columns that not every table has.
struct Columns {
  bool frame;
  bool protrusion;
};

using Values = std::vector<std::optional<double>>;

/// The values of one level over the frames.
template <class Figure>
Values over_frames(const std::vector<MeasuredFrame>& frames, std::size_t level, const Figure& figure_of) {
  Values values;
  for (const MeasuredFrame& frame : frames)
    values.push_back(level < frame.levels.size() ? figure_of(frame.levels[level]) : std::nullopt);
  return values;
}
std::optional<double> looseness_of(const LevelMeasure& level) {
  return level.looseness.looseness;
}
std::optional<double> uncovered_percent_of(const LevelMeasure& level) {
  return 100 * level.coverage.uncovered_area;
}

void add_level(Table& table, const Columns& columns, const std::string& frame, const LevelMeasure& level,
               const std::string& drawing) {
  std::vector<std::string> cells;
  if (columns.frame) cells.push_back(level.level == 0 ? frame : std::string());
  for (std::string cell :
       {std::to_string(level.level), std::to_string(level.spheres), figure_or_na(level.looseness.looseness),
        percent_or_na(level.looseness.missed_volume), percent(level.coverage.uncovered_area),
        figure(level.coverage.uncovered_distance), std::string(level.coverage.covered ? "yes" : "no")}) {
    cells.push_back(std::move(cell));
  }
  if (columns.protrusion) {
    cells.push_back(level.protrusion ? figure(level.protrusion->worst) : "n/a");
    cells.push_back(level.protrusion ? figure(level.protrusion->mean) : "n/a");
  }
  cells.push_back(drawing);
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
      w.coverage.uncovered_area = std::max(w.coverage.uncovered_area, level.coverage.uncovered_area);
      w.coverage.uncovered_distance = std::max(w.coverage.uncovered_distance, level.coverage.uncovered_distance);
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
  std::vector<std::string> header{"level",  "spheres", "looseness", "missed", "uncovered area", "uncovered distance",
                                  "covered"};
  if (columns.frame) header.insert(header.begin(), "frame");
  if (columns.protrusion) header.insert(header.end(), {"protrusion", "mean"});
  header.emplace_back(columns.frame ? "looseness over the frames" : "looseness below the root");
  Table table(header, columns.frame ? 1 : 0, true);
  // The root is one ball, far looser than all below it.
  double loosest = 0;
  for (const LevelMeasure& level : worst)
    if (level.level > 0) loosest = std::max(loosest, looseness_of(level).value_or(0));
  constexpr std::size_t width = 24;
  for (const MeasuredFrame& frame : frames) {
    for (const LevelMeasure& level : frame.levels) {
      const bool drawn = !columns.frame && level.level > 0 && loosest > 0;
      add_level(table, columns, frame.name, level,
                drawn ? bar(looseness_of(level).value_or(0) / loosest, width) : std::string());
    }
  }
  if (columns.frame) {
    table.add_rule();
    for (const LevelMeasure& level : worst)
      add_level(table, columns, "worst", level, sparkline(over_frames(frames, level.level, looseness_of), width));
  }
  return table.text();
}

std::string sampled_table(const std::vector<MeasuredFrame>& frames) {
  const bool several = frames.size() > 1;
  std::vector<std::string> header{"level", "spheres",        "covered", "outside", "mean",   "p95",
                                  "max",   "uncovered mean", "p95",     "max",     "volumes"};
  if (several) header.insert(header.begin(), "frame");
  Table table(header, several ? 1 : 0);
  for (const MeasuredFrame& frame : frames) {
    for (const LevelMeasure& level : frame.levels) {
      if (!level.sampled) continue;
      const SampledFit& s = *level.sampled;
      std::vector<std::string> cells;
      if (several) cells.push_back(level.level == 0 ? frame.name : std::string());
      for (std::string cell :
           {std::to_string(level.level), std::to_string(level.spheres), percent_or_na(s.coverage),
            percent_or_na(s.protrusion), figure_or_na(s.protrusion_mean), figure_or_na(s.protrusion_p95),
            figure_or_na(s.protrusion_max), figure(s.surface_gap_mean), figure(s.surface_gap_p95),
            figure(s.surface_gap_max), figure_or_na(s.volume_ratio)}) {
        cells.push_back(std::move(cell));
      }
      table.add(std::move(cells));
    }
  }
  return table.text();
}

toolbox::Plot measure_plot(const std::string& title, const std::vector<MeasuredFrame>& frames) {
  const std::vector<LevelMeasure> worst = worst_of(frames);
  toolbox::Plot plot{.title = title, .x_label = frames.size() > 1 ? "frame" : "level", .panels = {}};
  // The root is left out if there are more levels, as in the table.
  const std::size_t first = worst.size() > 1 ? 1 : 0;
  const auto add = [&](const std::string& name, const std::string& unit, const auto& figure_of) {
    toolbox::PlotPanel panel{.label = name + ", " + unit, .lines = {}};
    Values values;
    for (std::size_t level = first; level < worst.size(); ++level) {
      if (frames.size() > 1)
        panel.lines.push_back(
            line_over_frames(fmt::format("level {}", level), over_frames(frames, level, figure_of), level));
      values.push_back(figure_of(worst[level]));
    }
    if (frames.size() == 1) panel.lines.push_back(line_over_frames(name, values, 0));
    plot.panels.push_back(std::move(panel));
  };
  if (frames.size() == 1)
    for (std::size_t level = first; level < worst.size(); ++level)
      plot.x_names.push_back(fmt::format("{} ({})", level, counted(worst[level].spheres, "sphere")));
  add("looseness", "object volumes", looseness_of);
  add("uncovered area", "%", uncovered_percent_of);
  return plot;
}

std::string cover_sentence(const std::vector<LevelMeasure>& worst) {
  std::string uncovered;
  for (const LevelMeasure& level : worst) {
    if (level.coverage.covered) continue;
    uncovered +=
        fmt::format("{}level {} leaves {} uncovered, up to {} away", uncovered.empty() ? "" : "; ", level.level,
                    percent(level.coverage.uncovered_area), figure(level.coverage.uncovered_distance));
  }
  return uncovered.empty() ? "Covers: every level covers the whole surface."
                           : fmt::format("Does not cover: {}.", uncovered);
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
