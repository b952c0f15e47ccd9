// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Line plots as SVG: panels above each other over one axis, direct labels, readable on light and dark pages.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace morula::toolbox {

struct PlotLine {
  std::string name;
  std::vector<double> x;
  std::vector<std::optional<double>> y;  // gaps where there is none
  int color = 0;                         // of the palette, 0…7
  enum class Style { solid, dashed, dotted, dots } style = Style::solid;
  bool strong = true;  // thick, against thin ones in the background
};

struct PlotPanel {
  std::string label;  // of the y axis, with its unit
  std::vector<PlotLine> lines;
  double y_end = 0;  // the y axis ends there, or beyond it where a line does
};

struct Plot {
  std::string title;
  std::string x_label;
  std::vector<PlotPanel> panels;       // the first one is the tallest
  std::vector<std::string> x_names{};  // of x = 0, 1, …; none: numbers
};

/// Without fonts, scripts or colors of the page: a file by itself, or inline. The same plot gives the same bytes.
std::string svg_plot(const Plot& plot);

/// Round numbers from low to high, about `count` of them, with the digits they need.
struct Ticks {
  std::vector<double> values;
  int decimals = 0;
};
Ticks round_ticks(double low, double high, int count);

/// & < > " as entities.
std::string svg_escaped(std::string_view text);

}  // namespace morula::toolbox
