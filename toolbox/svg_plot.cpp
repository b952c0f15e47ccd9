// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <toolbox/svg_plot.hpp>

namespace morula::toolbox {
namespace {

constexpr double width = 760;
constexpr double left = 64;
constexpr double right = 24;
constexpr double title_size = 14;
constexpr double title_line = 22;
constexpr double legend_line = 19;
constexpr double swatch = 34;   // length of a line in the legend
constexpr double wider = 1.17;  // other fonts than Helvetica
constexpr double first_height = 250;
constexpr double other_height = 92;
constexpr double between = 34;
constexpr double bottom = 46;
constexpr double marker_size = 4.2;

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

Shade color_of(const PlotLine& line) {
  return palette[static_cast<std::size_t>(line.color) % palette.size()];
}

double thickness(const PlotLine& line) {
  return line.strong ? 2.2 : 1.4;
}

DrawnPath line_path(const PlotLine& line, const Frame& frame) {
  DrawnPath path;
  path.stroke = color_of(line);
  path.width = thickness(line);
  path.dash = line.dash;
  bool pen_down = false;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (line.y[i]) path.steps.push_back({pen_down ? 'L' : 'M', frame.x(line.x[i]), frame.y(*line.y[i])});
    pen_down = line.y[i].has_value();
  }
  return path;
}

/// Strokes that hang from the line wherever it is hatched: from each such point half way to its neighbors.
DrawnPath hatch_path(const PlotLine& line, const Frame& frame) {
  constexpr double apart = 5, reach_x = -3.5, reach_y = 7;
  DrawnPath path;
  path.stroke = color_of(line);
  path.width = 0.8;
  double walked = 0;  // since the last stroke
  for (std::size_t i = 0; i + 1 < line.x.size() && i + 1 < line.hatched.size(); ++i) {
    if (!line.y[i] || !line.y[i + 1] || !(line.hatched[i] || line.hatched[i + 1])) continue;
    const double x = frame.x(line.x[i]), y = frame.y(*line.y[i]);
    const double dx = frame.x(line.x[i + 1]) - x, dy = frame.y(*line.y[i + 1]) - y;
    const double size = std::hypot(dx, dy);
    const double end = line.hatched[i + 1] ? size : 0.5 * size;
    double at = (line.hatched[i] ? 0 : 0.5 * size) + (line.hatched[i] ? std::max(0.0, apart - walked) : apart);
    for (; at <= end; at += apart) {
      const double px = x + dx * at / size, py = y + dy * at / size;
      path.steps.push_back({'M', px, py});
      path.steps.push_back({'L', px + reach_x, py + reach_y});
    }
    walked = std::max(0.0, end - (at - apart));
  }
  return path;
}

/// A marker where the line ends, and wherever it is a single point.
void add_markers(const PlotLine& line, const Frame& frame, bool at_all_points, Drawing& drawing) {
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!line.y[i]) continue;
    const bool next = i + 1 < line.x.size() && line.y[i + 1];
    if (next && !line.dots && !at_all_points) continue;
    drawing.items.push_back(
        marker_path(line.marker, frame.x(line.x[i]), frame.y(*line.y[i]), marker_size, color_of(line), line.hollow));
  }
}

void add_line(const PlotLine& line, const Frame& frame, bool at_all_points, Drawing& drawing) {
  if (!line.dots) {
    const DrawnPath hatch = hatch_path(line, frame);
    if (!hatch.steps.empty()) drawing.items.push_back(hatch);
    const DrawnPath path = line_path(line, frame);
    if (!path.steps.empty()) drawing.items.push_back(path);
  }
  add_markers(line, frame, at_all_points, drawing);
}

/// The names of lines next to short samples, in rows that fit the page. Returns the height.
double add_legend(const Plot& plot, double top, Drawing& drawing) {
  double x = 12, y = top;
  const auto next = [&](std::string_view text) {
    const double needed = swatch + 6 + wider * text_width(text, 12) + 16;
    if (x > 12 && x + needed > width) x = 12, y += legend_line;
    const double at = x;
    x += needed;
    return at;
  };
  const auto add = [&](const PlotLine& line, const std::string& text) {
    const double at = next(text);
    if (!line.dots) {
      DrawnPath piece = line_between(at, y - 4, at + swatch, y - 4, color_of(line), thickness(line));
      piece.dash = line.dash;
      drawing.items.push_back(piece);
    }
    drawing.items.push_back(marker_path(line.marker, at + (line.dots ? 0.5 : 1) * swatch - 2, y - 4, marker_size,
                                        color_of(line), line.hollow));
    drawing.items.push_back(
        DrawnText{at + swatch + 6, y, shortened(text, 12, (width - 24 - swatch) / wider), shades::ink, 12});
  };
  std::vector<std::string> named;
  bool hatches = false;
  for (const PlotPanel& panel : plot.panels) {
    for (const PlotLine& line : panel.lines) {
      hatches = hatches || std::find(line.hatched.begin(), line.hatched.end(), true) != line.hatched.end();
      if (line.name.empty() || std::find(named.begin(), named.end(), line.name) != named.end()) continue;
      named.push_back(line.name);
      add(line, line.name);
    }
  }
  if (hatches && !plot.hatch_name.empty()) {
    const double at = next(plot.hatch_name);
    const Frame frame{at, at + swatch, y - 8, y - 9, 0, 1, 1};
    PlotLine sample{.name = "", .x = {0, 1}, .y = {0.0, 0.0}, .hatched = {true, true}};
    DrawnPath hatch = hatch_path(sample, frame), line = line_path(sample, frame);
    hatch.stroke = line.stroke = shades::muted;
    drawing.items.push_back(hatch);
    drawing.items.push_back(line);
    drawing.items.push_back(DrawnText{at + swatch + 6, y, plot.hatch_name, shades::muted, 12});
  }
  return y - top + legend_line;
}

void add_axes(const PlotPanel& panel, const Frame& frame, bool with_x, const Plot& plot, Drawing& drawing) {
  const auto text = [&](double x, double y, std::string words, Anchor anchor) {
    drawing.items.push_back(DrawnText{x, y, std::move(words), shades::muted, 12, anchor});
  };
  const bool tall = frame.y0 - frame.y1 > 150;
  const Ticks y = round_ticks(0, frame.high_y, tall ? 6 : 3);
  for (const double value : y.values) {
    drawing.items.push_back(line_between(frame.x0, frame.y(value), frame.x1, frame.y(value), shades::grid));
    text(frame.x0 - 8, frame.y(value) + 4, fmt::format("{:.{}f}", value, y.decimals), Anchor::end);
  }
  Ticks x = round_ticks(frame.low_x, frame.high_x, 7);
  if (!plot.x_names.empty()) {
    x.values.clear();
    for (std::size_t i = 0; i < plot.x_names.size(); ++i) x.values.push_back(static_cast<double>(i));
  }
  for (std::size_t i = 0; i < x.values.size(); ++i) {
    const double at = frame.x(x.values[i]);
    drawing.items.push_back(line_between(at, frame.y0, at, frame.y0 + 5, shades::axis));
    if (with_x)
      text(at, frame.y0 + 19, plot.x_names.empty() ? fmt::format("{:.{}f}", x.values[i], x.decimals) : plot.x_names[i],
           Anchor::middle);
  }
  drawing.items.push_back(line_between(frame.x0, frame.y0, frame.x1, frame.y0, shades::axis));
  text(10, frame.y1 - 9, panel.label, Anchor::start);
  if (with_x) text(0.5 * (frame.x0 + frame.x1), frame.y0 + 37, plot.x_label, Anchor::middle);
}

DrawnPath polygon(double x, double y, const std::vector<std::pair<double, double>>& corners) {
  DrawnPath path;
  for (const auto& [dx, dy] : corners) path.steps.push_back({path.steps.empty() ? 'M' : 'L', x + dx, y + dy});
  path.steps.push_back({'Z'});
  return path;
}

DrawnPath circle(double x, double y, double r) {
  const double k = 0.5523 * r;
  DrawnPath path;
  path.steps = {{'M', x + r, y},
                {'C', x, y + r, x + r, y + k, x + k, y + r},
                {'C', x - r, y, x - k, y + r, x - r, y + k},
                {'C', x, y - r, x - r, y - k, x - k, y - r},
                {'C', x + r, y, x + k, y - r, x + r, y - k},
                {'Z'}};
  return path;
}

}  // namespace

std::string_view name(Marker marker) {
  constexpr std::array<std::string_view, marker_count> names{"circle", "square",   "triangle", "diamond",
                                                             "down",   "pentagon", "cross",    "plus"};
  return names[static_cast<std::size_t>(marker)];
}

DrawnPath marker_path(Marker marker, double x, double y, double size, Shade color, bool hollow) {
  const double r = size;
  DrawnPath path;
  switch (marker) {
    case Marker::circle:
      path = circle(x, y, 0.9 * r);
      break;
    case Marker::square:
      path = polygon(x, y, {{-0.8 * r, -0.8 * r}, {0.8 * r, -0.8 * r}, {0.8 * r, 0.8 * r}, {-0.8 * r, 0.8 * r}});
      break;
    case Marker::triangle:
      path = polygon(x, y, {{0, -1.15 * r}, {r, 0.75 * r}, {-r, 0.75 * r}});
      break;
    case Marker::diamond:
      path = polygon(x, y, {{0, -1.2 * r}, {1.05 * r, 0}, {0, 1.2 * r}, {-1.05 * r, 0}});
      break;
    case Marker::down:
      path = polygon(x, y, {{0, 1.15 * r}, {r, -0.75 * r}, {-r, -0.75 * r}});
      break;
    case Marker::pentagon:
      path = polygon(
          x, y,
          {{0, -1.1 * r}, {1.05 * r, -0.34 * r}, {0.65 * r, 0.9 * r}, {-0.65 * r, 0.9 * r}, {-1.05 * r, -0.34 * r}});
      break;
    case Marker::cross:
    case Marker::plus: {
      const double d = marker == Marker::cross ? 0.8 * r : 0, s = marker == Marker::cross ? 0 : 1.05 * r;
      path.steps = {{'M', x - d - s, y - d}, {'L', x + d + s, y + d}, {'M', x - d, y + d + s}, {'L', x + d, y - d - s}};
      path.stroke = color;
      path.width = hollow ? 1.2 : 2;
      return path;
    }
  }
  path.fill = hollow ? shades::page : color;
  path.stroke = hollow ? color : shades::page;
  path.width = hollow ? 1.3 : 0.7;
  return path;
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

Drawing plot_drawing(const Plot& plot) {
  double low_x = 0;
  double high_x = 0;
  for (const PlotPanel& panel : plot.panels)
    for (const PlotLine& line : panel.lines)
      for (const double x : line.x) low_x = std::min(low_x, x), high_x = std::max(high_x, x);
  if (high_x <= low_x) high_x = low_x + 1;
  Drawing drawing{.width = width, .height = 0, .title = plot.title};
  const double room = (width - 20) / wider;
  const double size =
      std::clamp(title_size * room / std::max(text_width(plot.title, title_size, true), 1.0), 10.0, title_size);
  drawing.items.push_back(
      DrawnText{10, title_line, shortened(plot.title, size, room, true), shades::ink, size, Anchor::start, true});
  double y = title_line + 20;
  y += add_legend(plot, y, drawing) - 10;
  for (std::size_t i = 0; i < plot.panels.size(); ++i) {
    const PlotPanel& panel = plot.panels[i];
    y += between;
    const double panel_height = i == 0 ? first_height : other_height;
    const Frame frame{left, width - right, y + panel_height, y, low_x, high_x, 1.04 * highest(panel)};
    add_axes(panel, frame, i + 1 == plot.panels.size(), plot, drawing);
    for (const bool strong : {false, true})
      for (const PlotLine& line : panel.lines)
        if (line.strong == strong) add_line(line, frame, !plot.x_names.empty(), drawing);
    y += panel_height;
  }
  drawing.height = y + bottom;
  return drawing;
}

std::string svg_plot(const Plot& plot) {
  return svg_of(plot_drawing(plot));
}

std::string pdf_plot(const Plot& plot) {
  return pdf_of(plot_drawing(plot));
}

}  // namespace morula::toolbox
