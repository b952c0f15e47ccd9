// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Figures and tables of a study: curves over the samples of a motion, and data without curves.
#pragma once

#include <cstdint>
#include <morula/study/claims.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace morula::study {

enum class SeriesRole : std::uint8_t { method, reference, bare };
std::string_view name(SeriesRole role);

struct Series {
  std::string name;
  SeriesRole role = SeriesRole::method;
  std::vector<double> x;
  std::vector<std::optional<double>> y;
};

/// One measure with several curves.
struct Figure {
  std::string id;
  std::string group;  ///< figures of one group are drawn above each other, over the same axis
  std::string title;
  std::string note;
  std::string motion;  ///< its first word, such as stretch; or press
  std::size_t body = 0;
  std::string y_label;
  std::string y_unit;
  bool y_log = false;
  std::vector<Series> series;
  std::vector<std::string> x_names{};  ///< names of x = 0, 1, …; empty: x is the sample of the motion
  double y_end = 0;                    ///< the y axis ends there, or beyond it where a curve does
};

/// Figures of the first body: Fig. 2 of the paper, and every rule on every tree.
std::vector<Figure> make_figures(const Plan& plan, const Result& result);
/// Figures of contacts in presses: generators with exact, then the rules on one tree.
std::vector<Figure> make_press_figures(const Plan& plan, const Result& result);

/// Empty, a word, a count or a number.
using TableValue = std::variant<std::monostate, std::string, std::size_t, double>;

struct Table {
  std::string id;
  std::string title;
  std::string note;
  bool timed = false;  ///< contains times, which differ from run to run
  std::vector<std::string> columns;
  std::vector<std::vector<TableValue>> rows;
};

/// Trees and void spheres, means and worst samples of every rule, the floor, contacts, mixes, cost, bodies. of_bodies:
/// the claims of each body, in their order.
std::vector<Table> make_tables(const Plan& plan, const Result& result, const Cost& cost,
                               const std::vector<std::vector<Claim>>& of_bodies);

/// The label of an error, and its unit.
std::string error_label(ErrorUnit unit);
std::string error_unit(ErrorUnit unit);

}  // namespace morula::study
