// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Line plots: panels above each other over one axis and one legend, readable on light and dark pages and by the color
// blind. The files are SVG, PDF and pgfplots for LaTeX.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <toolbox/drawing.hpp>
#include <vector>

namespace morula::toolbox {

/// Eight colors for lines. Each has a contrast of at least 3 to its page, and two of them a distance of at least 20 in
/// CIELAB, also as people without one kind of cone see them.
constexpr std::array<Shade, 8> palette{{{0x293d89, 0x1e6bcb},
                                        {0x911a01, 0xe86f0a},
                                        {0x2e7956, 0x7effb4},
                                        {0xba6fa7, 0xad4782},
                                        {0x9b8e0e, 0xf4fa72},
                                        {0x1e91eb, 0x80b7f1},
                                        {0x410500, 0x977653},
                                        {0x3c3149, 0xcff4ff}}};

enum class Marker : std::uint8_t { circle, square, triangle, diamond, down, pentagon, cross, plus };
constexpr std::size_t marker_count = 8;
std::string_view name(Marker marker);

struct PlotLine {
  std::string name{};
  std::vector<double> x{};
  std::vector<std::optional<double>> y{};  // gaps where there is none
  int color = 0;                           // of the palette, 0…7
  bool strong = true;                      // thick, and thin ones in the background
  Marker marker = Marker::circle;          // at the end of the line, and at single points
  std::vector<double> dash{};              // strokes and gaps, page units; empty: a solid line
  bool hollow = false;                     // markers in the color of the page, with a border
  bool dots = false;                       // markers alone
  std::vector<bool> hatched{};             // points at which the line is hatched; empty: none
};

struct PlotPanel {
  std::string label;  // of the y axis, with its unit
  std::vector<PlotLine> lines;
  double y_end = 0;  // the y axis ends there, or beyond it where a line does
};

struct Plot {
  std::string title;
  std::string x_label;
  std::vector<PlotPanel> panels;       // the first one is the tallest; its lines are in the legend
  std::vector<std::string> x_names{};  // of x = 0, 1, …; none: numbers
  std::string hatch_name{};            // meaning of the hatch, for the legend
};

/// The title takes one line, the legend as many as it needs.
Drawing plot_drawing(const Plot& plot);
/// The same plot gives the same bytes.
std::string svg_plot(const Plot& plot);
std::string pdf_plot(const Plot& plot);
/// A tikzpicture of pgfplots, whose comment names the preamble. Coordinates have all digits.
std::string pgf_plot(const Plot& plot);

/// The marker around (x, y), with a radius of about `size`.
DrawnPath marker_path(Marker marker, double x, double y, double size, Shade color, bool hollow);

/// Round numbers from low to high, about `count` of them, with the digits they need.
struct Ticks {
  std::vector<double> values;
  int decimals = 0;
};
Ticks round_ticks(double low, double high, int count);

}  // namespace morula::toolbox
