// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <toolbox/drawing.hpp>

namespace morula::toolbox {
namespace {

// Widths of Helvetica's characters from ' ' to '~', in thousandths of the size (Adobe's font metrics).
constexpr std::array<short, 95> helvetica{
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};
constexpr double bold_factor = 1.07;  // Helvetica-Bold is wider by about this

constexpr double fine = 10;  // whole numbers in paths are tenths of page units

struct Place {
  long x = 0, y = 0;
};

Place rounded(double x, double y) {
  return {std::lround(fine * x), std::lround(fine * y)};
}

/// "12-3 4": a minus parts numbers by itself.
void append(std::string& path, long value, bool first) {
  if (!first && value >= 0) path += ' ';
  path += std::to_string(value);
}

void append(std::string& path, const Place& to, const Place& from, bool first) {
  append(path, to.x - from.x, first);
  append(path, to.y - from.y, false);
}

/// In tenths of page units: points after the first one relative to the one before.
std::string path_data(const DrawnPath& path) {
  std::string data;
  Place at, begin;
  char last = 0;
  for (const Step& step : path.steps) {
    const Place to = rounded(step.x, step.y);
    if (step.kind == 'Z') {
      data += 'z';
      at = begin;
    } else if (step.kind == 'M') {
      data += 'M';
      append(data, to, {}, true);
      at = begin = to;
    } else if (step.kind == 'C') {
      data += 'c';
      append(data, rounded(step.x1, step.y1), at, true);
      append(data, rounded(step.x2, step.y2), at, false);
      append(data, to, at, false);
      at = to;
    } else {
      if (last != 'L') data += 'l';
      append(data, to, at, last != 'L');
      at = to;
    }
    last = step.kind;
  }
  return data;
}

std::string hex(std::uint32_t color) {
  return fmt::format("#{:06x}", color);
}

/// 1.5 as "15": lengths in tenths.
std::string tenths(double length) {
  return fmt::format("{:g}", std::round(100 * fine * length) / 100);
}

class SvgWriter {
 public:
  explicit SvgWriter(const Drawing& drawing) : drawing_(drawing) {
    for (const auto& item : drawing.items) std::visit([&](const auto& it) { add(it); }, item);
    close_group();
  }

  std::string text() const {
    return fmt::format(
               "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
               "height=\"{1:.0f}\" role=\"img\" font-family=\"system-ui,Helvetica,Arial,sans-serif\" "
               "font-size=\"12\">\n<title>{2}</title>\n<style>{3}</style>\n{4}<rect class=\"p\" width=\"100%\" "
               "height=\"100%\"/>\n",
               drawing_.width, drawing_.height, svg_escaped(drawing_.title), style(), definitions()) +
           body_ + "</svg>\n";
  }

 private:
  std::string style() const {
    std::string light = fmt::format("svg{{color-scheme:light dark}}.p{{fill:{}}}", hex(shades::page.light));
    std::string dark = fmt::format(".p{{fill:{}}}", hex(shades::page.dark));
    for (const auto& [shade, number] : numbers_) {
      light += fmt::format(".f{0}{{fill:{1}}}.s{0}{{stroke:{1}}}", number, hex(shade.light));
      if (shade.dark != shade.light)
        dark += fmt::format(".f{0}{{fill:{1}}}.s{0}{{stroke:{1}}}", number, hex(shade.dark));
    }
    return light + "@media(prefers-color-scheme:dark){" + dark + "}";
  }
  std::string definitions() const {
    if (balls_.empty()) return {};
    return "<defs><radialGradient id=\"ball\" gradientUnits=\"userSpaceOnUse\"><stop offset=\"0\" "
           "stop-color=\"#d8ecf8\"/><stop offset=\".45\" stop-color=\"#8fc1e3\"/><stop offset=\".8\" "
           "stop-color=\"#3f86b8\"/><stop offset=\"1\" stop-color=\"#1f5583\"/></radialGradient>" +
           balls_ + "</defs>\n";
  }
  int number_of(const Shade& shade) {
    return numbers_.try_emplace(shade, static_cast<int>(numbers_.size())).first->second;
  }
  void close_group() {
    if (in_group_) body_ += "</g>\n";
    in_group_ = false;
  }

  void add(const DrawnPath& path) {
    if (!in_group_) body_ += "<g transform=\"scale(.1)\" fill=\"none\" stroke-linejoin=\"round\">\n";
    in_group_ = true;
    std::string look;
    if (path.ball) {
      const Ball& ball = *path.ball;
      balls_ += fmt::format(
          "<radialGradient id=\"b{}\" href=\"#ball\" cx=\"{:.0f}\" cy=\"{:.0f}\" r=\"{:.0f}\" fx=\"{:.0f}\" "
          "fy=\"{:.0f}\"/>",
          ball_count_, fine * ball.x, fine * ball.y, fine * ball.radius, fine * ball.focus_x, fine * ball.focus_y);
      look = fmt::format(" fill=\"url(#b{0})\" stroke=\"url(#b{0})\"", ball_count_++);
    } else {
      std::string classes;
      if (path.fill) classes += fmt::format("f{}", number_of(*path.fill));
      if (path.stroke) classes += fmt::format("{}s{}", classes.empty() ? "" : " ", number_of(*path.stroke));
      look = fmt::format(" class=\"{}\"", classes);
    }
    if (path.stroke || path.ball) look += fmt::format(" stroke-width=\"{}\"", tenths(path.width));
    if (!path.dash.empty()) {
      std::string dashes;
      for (const double length : path.dash) dashes += (dashes.empty() ? "" : " ") + tenths(length);
      look += fmt::format(" stroke-dasharray=\"{}\"", dashes);
    }
    if (path.even_odd) look += " fill-rule=\"evenodd\"";
    body_ += fmt::format("<path{} d=\"{}\"/>\n", look, path_data(path));
  }
  void add(const DrawnText& text) {
    close_group();
    body_ += fmt::format("<text class=\"f{}\" x=\"{:.1f}\" y=\"{:.1f}\"", number_of(text.color), text.x, text.y);
    if (text.size != 12) body_ += fmt::format(" font-size=\"{:g}\"", std::round(100 * text.size) / 100);
    if (text.anchor != Anchor::start)
      body_ += fmt::format(" text-anchor=\"{}\"", text.anchor == Anchor::end ? "end" : "middle");
    if (text.bold) body_ += " font-weight=\"600\"";
    body_ += fmt::format(">{}</text>\n", svg_escaped(text.text));
  }

  const Drawing& drawing_;
  std::string body_, balls_;
  std::map<Shade, int> numbers_;
  int ball_count_ = 0;
  bool in_group_ = false;
};

}  // namespace

DrawnPath line_between(double x0, double y0, double x1, double y1, Shade color, double width) {
  DrawnPath path;
  path.steps = {{'M', x0, y0}, {'L', x1, y1}};
  path.stroke = color;
  path.width = width;
  return path;
}

double text_width(std::string_view text, double size, bool bold) {
  double width = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 && byte < 0xc0) continue;  // counted with the first byte of its character
    width += byte >= ' ' && byte <= '~' ? helvetica[byte - static_cast<std::size_t>(' ')] : 556;
  }
  return width / 1000 * size * (bold ? bold_factor : 1);
}

std::string shortened(std::string_view text, double size, double most, bool bold) {
  if (text_width(text, size, bold) <= most) return std::string(text);
  std::string begin(text);
  while (!begin.empty() && text_width(begin + "...", size, bold) > most) {
    while (begin.size() > 1 && (static_cast<unsigned char>(begin.back()) & 0xc0) == 0x80) begin.pop_back();
    begin.pop_back();
  }
  return begin + "...";
}

std::string svg_of(const Drawing& drawing) {
  return SvgWriter(drawing).text();
}

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

}  // namespace morula::toolbox
