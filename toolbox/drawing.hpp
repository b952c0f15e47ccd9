// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Drawings as paths and texts, and their two files: SVG for pages of either shade, PDF for print.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace morula::toolbox {

/// One color on light pages and its counterpart on dark ones, as 0xRRGGBB.
struct Shade {
  std::uint32_t light = 0, dark = 0;
  bool operator==(const Shade&) const = default;
  auto operator<=>(const Shade&) const = default;
};

namespace shades {
constexpr Shade page{0xffffff, 0x16181c};
constexpr Shade ink{0x222222, 0xe8e8e8};
constexpr Shade muted{0x555555, 0xaaaaaa};
constexpr Shade axis{0x777777, 0x8b8f96};
constexpr Shade grid{0xe2e2e2, 0x2e3238};
}  // namespace shades

/// M, L: to a point. C: a cubic curve to a point with two control points. Z: back to the last M.
struct Step {
  char kind = 'M';
  double x = 0, y = 0;
  double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
};

/// A circle that is lit from above and left, as the color of a path. focus: its brightest point.
struct Ball {
  double x = 0, y = 0, radius = 0;
  double focus_x = 0, focus_y = 0;
};

struct DrawnPath {
  std::vector<Step> steps{};
  std::optional<Shade> fill{};
  std::optional<Shade> stroke{};
  double width = 1;
  std::vector<double> dash{};  ///< lengths of strokes and gaps; empty: a solid line
  std::optional<Ball> ball{};  ///< fills and strokes the path, instead of `fill` and `stroke`
  bool even_odd = false;
};

enum class Anchor : std::uint8_t { start, middle, end };

struct DrawnText {
  double x = 0, y = 0;  ///< left, middle or right end of the baseline
  std::string text{};
  Shade color = shades::ink;
  double size = 12;
  Anchor anchor = Anchor::start;
  bool bold = false;
};

/// Items are drawn in their order, over the color of the page. Lengths are page units; y points down.
struct Drawing {
  double width = 0, height = 0;
  std::string title{};
  std::vector<std::variant<DrawnPath, DrawnText>> items{};
};

/// A straight line.
DrawnPath line_between(double x0, double y0, double x1, double y1, Shade color, double width = 1);

/// The width of a text in Helvetica. Other fonts of its kind are up to a sixth wider.
double text_width(std::string_view text, double size, bool bold = false);
/// The text itself, or its beginning and an ellipsis if it is wider than `most`.
std::string shortened(std::string_view text, double size, double most, bool bold = false);

/// A file by itself, or inline: without fonts and scripts; it follows the reader's choice of light or dark.
std::string svg_of(const Drawing& drawing);
/// PDF 1.4 of one page in the light colors, with the standard font Helvetica. The same drawing gives the same bytes.
std::string pdf_of(const Drawing& drawing);

/// & < > " as entities.
std::string svg_escaped(std::string_view text);
/// UTF-8 as the bytes of PDF's WinAnsiEncoding; '?' for characters that it lacks.
std::string win_ansi(std::string_view text);

}  // namespace morula::toolbox
