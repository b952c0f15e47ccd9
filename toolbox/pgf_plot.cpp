// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Plots for LaTeX: one axis of pgfplots per panel.
#include <fmt/format.h>

#include <algorithm>
#include <toolbox/numbers.hpp>
#include <toolbox/svg_plot.hpp>

namespace morula::toolbox {
namespace {

/// Text as LaTeX takes it.
std::string tex_escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\textbackslash{}";
    } else if (c == '~' || c == '^') {
      safe += fmt::format("\\{}{{}}", c);
    } else if (std::string_view("#$%&_{}").find(c) != std::string_view::npos) {
      safe += '\\';
      safe += c;
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string_view tex_mark(Marker marker, bool hollow) {
  switch (marker) {
    case Marker::circle:
      return hollow ? "o" : "*";
    case Marker::square:
      return hollow ? "square" : "square*";
    case Marker::triangle:
      return hollow ? "triangle" : "triangle*";
    case Marker::diamond:
      return hollow ? "diamond" : "diamond*";
    case Marker::down:
      return hollow ? "triangle,mark options={solid,rotate=180}" : "triangle*,mark options={solid,rotate=180}";
    case Marker::pentagon:
      return hollow ? "pentagon" : "pentagon*";
    case Marker::cross:
      return "x";
    case Marker::plus:
      return "+";
  }
  return "*";
}

std::string dash_pattern(const std::vector<double>& dash) {
  if (dash.empty()) return "solid";
  std::string text = "dash pattern=";
  for (std::size_t i = 0; i < dash.size(); ++i)
    text += fmt::format("{}{} {:g}bp", i == 0 ? "" : " ", i % 2 == 0 ? "on" : "off", dash[i]);
  return text;
}

std::string coordinates(const PlotLine& line) {
  std::string text = "coordinates {";
  for (std::size_t i = 0; i < line.x.size(); ++i)
    text += fmt::format("({},{})", exact_digits(line.x[i]), line.y[i] ? exact_digits(*line.y[i]) : "nan");
  return text + "};\n";
}

/// The hatched points with gaps elsewhere: hatch hangs from the line between two of them.
std::string hatch(const PlotLine& line, int color) {
  PlotLine part = line;
  for (std::size_t i = 0; i < part.y.size(); ++i)
    if (i >= part.hatched.size() || !part.hatched[i]) part.y[i] = std::nullopt;
  return fmt::format(
      "\\addplot[draw=none,forget plot,postaction={{draw=morula{},line width=0.4pt,decorate,"
      "decoration={{border,angle=-60,amplitude=4pt,segment length=3pt}}}}] {}",
      color, coordinates(part));
}

/// A label in lines, broken at its commas: low panels have no room for it in one.
std::string tex_lines(std::string_view text) {
  std::string lines;
  for (std::size_t comma = text.find(", "); comma != std::string_view::npos; comma = text.find(", ")) {
    lines += tex_escaped(text.substr(0, comma + 1)) + "\\\\";
    text.remove_prefix(comma + 2);
  }
  return lines + tex_escaped(text);
}

std::string axis(const Plot& plot, const PlotPanel& panel, std::size_t number) {
  const bool first = number == 0, last = number + 1 == plot.panels.size();
  std::string text =
      fmt::format("\\nextgroupplot[ylabel={{{}}},height={}", tex_lines(panel.label), first ? "6.5cm" : "4.3cm");
  if (first) text += fmt::format(",title={{{}}}", tex_escaped(plot.title));
  if (first) text += ",legend columns=3,legend cell align=left,legend style={at={(0.5,1.14)},anchor=south}";
  if (last) text += fmt::format(",xlabel={{{}}}", tex_escaped(plot.x_label));
  if (!plot.x_names.empty()) {
    std::string ticks, labels;
    for (std::size_t i = 0; i < plot.x_names.size(); ++i) {
      ticks += fmt::format("{}{}", i == 0 ? "" : ",", i);
      labels += fmt::format("{}{{{}}}", i == 0 ? "" : ",", tex_escaped(plot.x_names[i]));
    }
    text += fmt::format(",xtick={{{}}},xticklabels={{{}}}", ticks, labels);
  }
  text += "]\n";
  for (const PlotLine& line : panel.lines) {
    const int color = line.color % static_cast<int>(palette.size());
    text += fmt::format("% {}\n\\addplot[morula{},{},line width={},{}mark={}{}] ", line.name, color,
                        dash_pattern(line.dash), line.strong ? "1.1pt" : "0.7pt", line.dots ? "only marks," : "",
                        tex_mark(line.marker, line.hollow),
                        line.dots || !plot.x_names.empty() ? "" : fmt::format(",mark indices={{{}}}", line.x.size()));
    text += coordinates(line);
    if (first) text += fmt::format("\\addlegendentry{{{}}}\n", tex_escaped(line.name));
    if (std::find(line.hatched.begin(), line.hatched.end(), true) != line.hatched.end()) text += hatch(line, color);
  }
  return text;
}

}  // namespace

std::string pgf_plot(const Plot& plot) {
  std::string text = fmt::format(
      "% {}\n% Preamble: \\usepackage{{pgfplots}} \\pgfplotsset{{compat=1.16}} \\usepgfplotslibrary{{groupplots}}\n"
      "% \\usetikzlibrary{{decorations.pathreplacing}}; with pdfLaTeX also \\usepackage[utf8]{{inputenc}} and "
      "\\usepackage{{textcomp}}.\n",
      plot.title);
  if (!plot.hatch_name.empty()) text += fmt::format("% Hatched lines: {}.\n", plot.hatch_name);
  text += "\\begin{tikzpicture}\n";
  for (std::size_t i = 0; i < palette.size(); ++i)
    text += fmt::format("\\definecolor{{morula{}}}{{HTML}}{{{:06X}}}\n", i, palette[i].light);
  text += fmt::format(
      "\\begin{{groupplot}}[group style={{group size=1 by {},vertical sep=1.1cm}},width=13cm,ymin=0,enlarge x "
      "limits=0.03,"
      "unbounded coords=jump,every mark/.append style={{solid}},legend style={{draw=none,font=\\footnotesize}},"
      "label style={{font=\\footnotesize,align=center}},tick label style={{font=\\footnotesize}},title "
      "style={{font=\\small}}]\n",
      plot.panels.size());
  for (std::size_t i = 0; i < plot.panels.size(); ++i) text += axis(plot, plot.panels[i], i);
  return text + "\\end{groupplot}\n\\end{tikzpicture}\n";
}

}  // namespace morula::toolbox
