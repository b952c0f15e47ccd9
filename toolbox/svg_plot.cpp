// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <toolbox/svg_plot.hpp>

namespace morula::toolbox {
namespace {

constexpr double width = 760;
constexpr double left = 64;
constexpr double right = 170;  // room for the labels at the ends of lines
constexpr double top = 44;
constexpr double first_height = 250;
constexpr double other_height = 92;
constexpr double between = 26;
constexpr double bottom = 46;

// Okabe and Ito's colors, told apart by the color blind; black and yellow replaced for pages of either shade.
constexpr std::array<std::string_view, 8> palette{"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                  "#e69f00", "#56b4e9", "#8c6d4f", "#808080"};

/// The range of a panel; it begins at 0, since areas and volumes do.
double highest(const PlotPanel& panel) {
  double high = panel.y_end;
  for (const PlotLine& line : panel.lines)
    for (const std::optional<double>& y : line.y) high = std::max(high, y.value_or(0));
  return high > 0 ? high : 1;
}

struct Frame {
  double x0, x1, y0, y1;         // on the page, y0 below
  double low_x, high_x, high_y;  // of the data
  double x(double value) const { return x0 + (value - low_x) / (high_x - low_x) * (x1 - x0); }
  double y(double value) const { return y0 - value / high_y * (y0 - y1); }
};

std::string line_path(const PlotLine& line, const Frame& frame) {
  std::string path;
  bool pen_down = false;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!line.y[i]) {
      pen_down = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen_down ? "L" : "M", frame.x(line.x[i]), frame.y(*line.y[i]));
    pen_down = true;
  }
  return path;
}

std::string_view dash(PlotLine::Style style) {
  return style == PlotLine::Style::dashed   ? " stroke-dasharray=\"7 4\""
         : style == PlotLine::Style::dotted ? " stroke-dasharray=\"1.5 4\" stroke-linecap=\"round\""
                                            : "";
}

std::string draw_line(const PlotLine& line, const Frame& frame) {
  const std::string_view color = palette[static_cast<std::size_t>(line.color) % palette.size()];
  std::string svg;
  if (line.style != PlotLine::Style::dots) {
    svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", line_path(line, frame),
                       color, line.strong ? "2.4" : "1.3", dash(line.style));
  }
  if (!line.strong && line.style != PlotLine::Style::dots) return svg;
  svg += fmt::format("<g fill=\"{}\">", color);
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!line.y[i]) continue;
    const double x = frame.x(line.x[i]);
    const double y = frame.y(*line.y[i]);
    if (line.style == PlotLine::Style::dots) {
      svg += fmt::format("<path d=\"M{:.1f} {:.1f}l4.5 4.5l-4.5 4.5l-4.5 -4.5z\"/>", x, y - 4.5);
    } else {
      svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\"/>", x, y);
    }
  }
  return svg + "</g>\n";
}

struct Label {
  double y;
  const PlotLine* line;
};

/// Names at the ends of the lines, moved apart where they would overlap.
std::string draw_labels(const PlotPanel& panel, const Frame& frame) {
  std::vector<Label> labels;
  for (const PlotLine& line : panel.lines) {
    for (std::size_t i = line.x.size(); i-- > 0;) {
      if (!line.y[i]) continue;
      labels.push_back({frame.y(*line.y[i]), &line});
      break;
    }
  }
  std::stable_sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
  constexpr double apart = 14.5;
  std::vector<double> places;
  for (const Label& label : labels)
    places.push_back(places.empty() ? std::max(label.y, frame.y1) : std::max(label.y, places.back() + apart));
  double floor = frame.y0 + 4;
  for (std::size_t i = places.size(); i-- > 0;) {
    places[i] = std::min(places[i], floor);
    floor = places[i] - apart;
  }
  std::string svg;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const PlotLine& line = *labels[i].line;
    const std::string_view color = palette[static_cast<std::size_t>(line.color) % palette.size()];
    svg += fmt::format(
        "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"{}\" stroke-width=\"{}\" fill=\"none\"{}/>"
        "<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n",
        frame.x1 + 6, labels[i].y, frame.x1 + 24, places[i], color, line.strong ? 1.6 : 1.0,
        line.style == PlotLine::Style::dots ? "" : dash(line.style), frame.x1 + 28, places[i] + 4,
        line.strong ? " font-weight=\"600\"" : "", svg_escaped(line.name));
  }
  return svg;
}

std::string draw_axes(const PlotPanel& panel, const Frame& frame, bool with_x, const Plot& plot) {
  std::string svg;
  const bool tall = frame.y0 - frame.y1 > 150;
  const Ticks y = round_ticks(0, frame.high_y, tall ? 6 : 3);
  for (const double value : y.values) {
    svg += fmt::format("<path class=\"g\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>", frame.x0, frame.y(value), frame.x1);
    svg += fmt::format("<text class=\"t\" text-anchor=\"end\" x=\"{:.1f}\" y=\"{:.1f}\">{:.{}f}</text>\n", frame.x0 - 8,
                       frame.y(value) + 4, value, y.decimals);
  }
  Ticks x = round_ticks(frame.low_x, frame.high_x, 7);
  if (!plot.x_names.empty()) {
    x.values.clear();
    for (std::size_t i = 0; i < plot.x_names.size(); ++i) x.values.push_back(static_cast<double>(i));
  }
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const double at = frame.x(x.values[i]);
    svg += fmt::format("<path class=\"a\" d=\"M{:.1f} {:.1f}v5\"/>", at, frame.y0);
    if (with_x) {
      svg += fmt::format(
          "<text class=\"t\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", at, frame.y0 + 19,
          plot.x_names.empty() ? fmt::format("{:.{}f}", x.values[i], x.decimals) : svg_escaped(plot.x_names[i]));
    }
  }
  svg += fmt::format("<path class=\"a\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>\n", frame.x0, frame.y0, frame.x1);
  svg += fmt::format("<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", frame.x0 - 54, frame.y1 - 9,
                     svg_escaped(panel.label));
  if (with_x) {
    svg += fmt::format("<text class=\"t\" text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                       0.5 * (frame.x0 + frame.x1), frame.y0 + 37, svg_escaped(plot.x_label));
  }
  return svg;
}

}  // namespace

std::string svg_escaped(std::string_view text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&') {
      safe += "&amp;";
    } else if (c == '<') {
      safe += "&lt;";
    } else if (c == '>') {
      safe += "&gt;";
    } else if (c == '"') {
      safe += "&quot;";
    } else {
      safe += c;
    }
  }
  return safe;
}

Ticks round_ticks(double low, double high, int count) {
  Ticks ticks;
  const double rough = (high - low) / std::max(count, 1);
  if (!(rough > 0) || !std::isfinite(rough)) {
    ticks.values.push_back(low);
    return ticks;
  }
  const double power = std::pow(10, std::floor(std::log10(rough)));
  double step = power;
  for (const double factor : {10.0, 5.0, 2.0, 1.0})
    if (factor * power >= rough * 0.99) step = factor * power;
  ticks.decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
  for (double k = std::ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9) + 1e-300; ++k)
    ticks.values.push_back(k == 0 ? 0.0 : k * step);  // not -0
  return ticks;
}

std::string svg_plot(const Plot& plot) {
  double low_x = 0;
  double high_x = 0;
  for (const PlotPanel& panel : plot.panels)
    for (const PlotLine& line : panel.lines)
      for (const double x : line.x) low_x = std::min(low_x, x), high_x = std::max(high_x, x);
  if (high_x <= low_x) high_x = low_x + 1;
  double height = top;
  for (std::size_t i = 0; i < plot.panels.size(); ++i) height += (i == 0 ? first_height : other_height) + between;
  height += bottom;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "role=\"img\" font-family=\"system-ui,Helvetica,Arial,sans-serif\" font-size=\"12\">\n<title>{2}</title>\n"
      "<style>svg{{color-scheme:light "
      "dark}}text{{fill:#222}}.t{{fill:#555}}.g{{stroke:#888;stroke-opacity:.22;fill:none}}"
      ".a{{stroke:#777;fill:none}}.p{{fill:#fff}}@media(prefers-color-scheme:dark){{text{{fill:#e8e8e8}}.t{{fill:#aaa}}"
      ".p{{fill:#16181c}}}}</style>\n<rect class=\"p\" width=\"100%\" height=\"100%\"/>\n"
      "<text x=\"10\" y=\"22\" font-size=\"14\" font-weight=\"600\">{2}</text>\n",
      width, height, svg_escaped(plot.title));
  double y = top;
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    const PlotPanel& panel = plot.panels[i];
    y += between;
    const double panel_height = i == 0 ? first_height : other_height;
    const Frame frame{left, width - right, y + panel_height, y, low_x, high_x, 1.04 * highest(panel)};
    svg += draw_axes(panel, frame, i + 1 == plot.panels.size(), plot);
    for (const bool strong : {false, true})
      for (const PlotLine& line : panel.lines)
        if (line.strong == strong) svg += draw_line(line, frame);
    if (i == 0) svg += draw_labels(panel, frame);
    y += panel_height;
  }
  return svg + "</svg>\n";
}

}  // namespace morula::toolbox
