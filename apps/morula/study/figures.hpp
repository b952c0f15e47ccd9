// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The figures of the study: curves over the samples of a motion, looseness with its bare area, gap and protrusion.
#pragma once

#include "study/run.hpp"

namespace morula::cli {

enum class SeriesRole : std::uint8_t { method, reference, bare };
std::string_view name(SeriesRole role);

struct StudySeries {
  std::string name;
  SeriesRole role = SeriesRole::method;
  std::vector<double> x;
  std::vector<std::optional<double>> y;
};

/// One measure of several curves.
struct StudyFigure {
  std::string id;
  std::string group;  // figures of one group are drawn above each other, over the same axis
  std::string title;
  std::string note;
  std::string motion;  // the first word: stretch
  std::string body;
  std::string y_label;
  std::string y_unit;
  bool y_log = false;
  std::vector<StudySeries> series;
  std::vector<std::string> x_names{};  // of x = 0, 1, …; none: x is the sample of the motion
};

/// Of the first body. Fig. 2 of the paper, and every rule on every tree.
std::vector<StudyFigure> make_figures(const StudyPlan& plan, const StudyResult& result);
/// What contacts say of a press: generators with exact, then the rules on one tree.
std::vector<StudyFigure> make_press_figures(const StudyPlan& plan, const StudyResult& result);
Json figure_json(const StudyFigure& figure);

struct StudyTable {
  std::string id;
  std::string title;
  std::string note;
  bool timed = false;  // holds times, which differ from run to run
  std::vector<std::string> columns;
  std::vector<std::vector<Json>> rows;
};
Json table_json(const StudyTable& table);
/// Every press. Without rows when there is none.
StudyTable make_press_table(const StudyPlan& plan, const StudyResult& result);

/// "Approach 1", as the paper writes it; our own rules by name.
std::string rule_title(const std::string& rule);
/// "stretch" of "stretch 2".
std::string first_word(const std::string& text);
/// What errors are called and their unit.
std::string error_label(ErrorUnit unit);
std::string error_unit(ErrorUnit unit);

}  // namespace morula::cli
