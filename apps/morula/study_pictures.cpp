// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace morula::cli {
namespace {

/// The colour of a curve: the same for one rule, or one generator, in all plots.
int color_of(const std::string& series) {
  static const std::vector<std::pair<std::string, int>> colors{
      {"Approach 1", 1},  {"Approach 2", 0}, {"traditional", 4}, {"weighted", 6}, {"exact, re-fitted", 5},
      {"fresh build", 7}, {"exact", 2},      {"medial", 0},      {"grid", 2},     {"hubbard", 1},
      {"spawn", 3},       {"morula", 7}};
  for (const auto& [begin, color] : colors)
    if (series.rfind(begin, 0) == 0) return color;
  return 7;
}

}  // namespace

Plot plot_of(const std::vector<const StudyFigure*>& group) {
  Plot plot{
      group.front()->title, fmt::format("sample (0 is rest, the last one the full {})", group.front()->motion), {}};
  for (const StudyFigure* figure : group) {
    PlotPanel panel{fmt::format("{}, {}", figure->y_label, figure->y_unit), {}};
    for (const StudySeries& s : figure->series) {
      PlotLine line{s.name, s.x, s.y, color_of(s.name), PlotLine::Style::solid, s.role != SeriesRole::reference};
      if (s.name.find("fresh") != std::string::npos) {
        line.style = PlotLine::Style::dots;
      } else if (!line.strong) {
        line.style = PlotLine::Style::dashed;
      }
      panel.lines.push_back(std::move(line));
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

std::vector<StudyPicture> make_pictures(const StudyPlan& plan, const StudyResult& result,
                                        const std::vector<StudyFigure>& figures) {
  (void)plan;
  (void)result;
  (void)figures;
  return {};
}

}  // namespace morula::cli
