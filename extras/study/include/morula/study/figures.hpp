// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures and tables of a study. A figure has curves over the samples of a motion or over the queries of a press;
// tables have the other results.
#pragma once

#include <cstdint>
#include <morula/study/claims.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace morula::study {

/// The part that a curve plays in its figure.
enum class SeriesRole : std::uint8_t {
  method,     ///< a method or rule that the figure compares
  reference,  ///< another method or rule, drawn thin for orientation
  uncovered   ///< a curve of `method` whose measure is uncovered surface or lost crossings
};
/// The name of the enumerator.
std::string_view name(SeriesRole role);

struct Series {
  std::string name;
  SeriesRole role = SeriesRole::method;
  std::vector<double> x;                 ///< samples of the motion, or queries of the press
  std::vector<std::optional<double>> y;  ///< one per x, in Figure::y_unit; no value: not measured
  std::string rule{};                    ///< name of its rule; curves of one rule look alike in all figures
  std::string method{};                  ///< name of its generator, in figures that compare generators
  bool faint = false;                    ///< a companion in the background, such as the values of spheres
  std::vector<bool> uncovered{};         ///< samples at which the rule leaves surface uncovered; empty: not known
};

/// One measure with several curves.
struct Figure {
  std::string id;
  std::string group;  ///< id of the group: figures of one group are drawn one above the other, with one x axis
  std::string title;
  std::string note;
  std::string motion;    ///< first word of the motion, such as "stretch"; "press" for a press
  std::size_t body = 0;  ///< index in Plan::bodies
  std::string y_label;
  std::string y_unit;
  bool y_log = false;  ///< true: logarithmic y axis
  std::vector<Series> series;
  std::vector<std::string> x_names{};  ///< names of the queries x = 0, 1, …; empty: x is a sample of the motion
  double y_end = 0;                    ///< the y axis ends there, or beyond it where a curve does
};

/// Figures of the first trial, which is of the first body and the first seed: Fig. 2 of the paper, and every rule on
/// every tree.
std::vector<Figure> make_figures(const Plan& plan, const Result& result);
/// Figures of the first body's presses at the middle one of Plan::press_amounts, for each axis: all trees with the rule
/// `exact`, then all rules on the medial tree, or on the first tree if there is no medial one.
std::vector<Figure> make_press_figures(const Plan& plan, const Result& result);

/// A cell of a table: empty, text, a count or a number.
using TableValue = std::variant<std::monostate, std::string, std::size_t, double>;

struct Table {
  std::string id;
  std::string title;
  std::string note;
  bool timed = false;                         ///< true: contains times, which differ from run to run
  std::vector<std::string> columns;           ///< headings, with units
  std::vector<std::vector<TableValue>> rows;  ///< one value per column
};

/// Trees and void spheres, means and worst samples of every rule, the floor, contacts, mixes, cost, trials. of_trials:
/// the claims of each trial, in their order.
std::vector<Table> make_tables(const Plan& plan, const Result& result, const Cost& cost,
                               const std::vector<std::vector<Claim>>& of_trials);

/// The label of the y axis for this divisor of looseness: "looseness" or "outside volume".
std::string error_label(ErrorUnit unit);
/// The unit of that axis: "object volumes" or "boxes of the object at rest".
std::string error_unit(ErrorUnit unit);

}  // namespace morula::study
