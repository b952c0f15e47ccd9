// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Drawings as PDF: one page, two standard fonts, no compression.
#include <fmt/format.h>

#include <cmath>
#include <toolbox/drawing.hpp>

namespace morula::toolbox {
namespace {

/// Up to three digits after the point; never "-0".
std::string number(double value) {
  const double rounded = std::round(1000 * value) / 1000;
  return fmt::format("{:.7g}", rounded == 0 ? 0.0 : rounded);
}

std::string color(std::uint32_t rgb) {
  const auto part = [&](int shift) { return number(static_cast<double>((rgb >> shift) & 0xff) / 255); };
  return fmt::format("{} {} {}", part(16), part(8), part(0));
}

/// (text), with a backslash before parentheses and backslashes, and bytes above ASCII as octal numbers.
std::string pdf_string(std::string_view bytes) {
  std::string text = "(";
  for (const char c : bytes) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '(' || c == ')' || c == '\\') {
      text += '\\';
      text += c;
    } else if (byte < ' ' || byte > '~') {
      text += fmt::format("\\{:03o}", byte);
    } else {
      text += c;
    }
  }
  return text + ")";
}

class PdfWriter {
 public:
  explicit PdfWriter(const Drawing& drawing) : drawing_(drawing) {
    for (const auto& item : drawing.items) std::visit([&](const auto& it) { add(it); }, item);
  }

  std::string text() const {
    std::vector<std::string> objects{
        "<< /Type /Catalog /Pages 2 0 R >>",
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        page_object(),
        stream(content_),
        font("Helvetica"),
        font("Helvetica-Bold"),
        fmt::format("<< /Title {} /Producer (Morula) >>", pdf_string(win_ansi(drawing_.title))),
        ball_colors()};
    std::string file = "%PDF-1.4\n%\xc7\xec\x8f\xa2\n";
    std::string table = fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
    for (std::size_t i = 0; i < objects.size(); ++i) {
      table += fmt::format("{:010} 00000 n \n", file.size());
      file += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
    }
    const std::size_t start = file.size();
    return file + table +
           fmt::format("trailer\n<< /Size {} /Root 1 0 R /Info 7 0 R >>\nstartxref\n{}\n%%EOF\n", objects.size() + 1,
                       start);
  }

 private:
  std::string page_object() const {
    return fmt::format(
        "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {} {}] /Contents 4 0 R /Resources << /Font << /F1 5 0 R /F2 6 0 R "
        ">> /Pattern << {}>> >> >>",
        number(drawing_.width), number(drawing_.height), patterns_);
  }
  static std::string stream(const std::string& content) {
    return fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content);
  }
  static std::string font(const char* name) {
    return fmt::format("<< /Type /Font /Subtype /Type1 /BaseFont /{} /Encoding /WinAnsiEncoding >>", name);
  }
  /// The colors of a ball from its focus to its border, as in SVG.
  static std::string ball_colors() {
    const auto between = [](std::uint32_t from, std::uint32_t to) {
      return fmt::format("<< /FunctionType 2 /Domain [0 1] /N 1 /C0 [{}] /C1 [{}] >>", color(from), color(to));
    };
    return fmt::format(
        "<< /FunctionType 3 /Domain [0 1] /Bounds [0.45 0.8] /Encode [0 1 0 1 0 1] /Functions [{} {} {}] >>",
        between(0xd8ecf8, 0x8fc1e3), between(0x8fc1e3, 0x3f86b8), between(0x3f86b8, 0x1f5583));
  }

  std::string point(double x, double y) const { return number(x) + " " + number(drawing_.height - y); }

  void add(const DrawnPath& path) {
    if (path.ball) {
      const Ball& b = *path.ball;
      patterns_ += fmt::format(
          "/B{} << /PatternType 2 /Shading << /ShadingType 3 /ColorSpace /DeviceRGB /Coords [{} 0 {} {}] /Function 8 0 "
          "R "
          "/Extend [true true] >> >> ",
          ball_count_, point(b.focus_x, b.focus_y), point(b.x, b.y), number(b.radius));
      content_ += fmt::format("/Pattern cs /B{0} scn /Pattern CS /B{0} SCN\n", ball_count_++);
    }
    if (path.fill) content_ += color(path.fill->light) + " rg\n";
    if (path.stroke) content_ += color(path.stroke->light) + " RG\n";
    const bool strokes = path.stroke || path.ball;
    if (strokes) {
      content_ += number(path.width) + " w 1 j [";
      for (const double length : path.dash) content_ += number(length) + " ";
      content_ += "] 0 d\n";
    }
    for (const Step& step : path.steps) {
      if (step.kind == 'Z') {
        content_ += "h\n";
      } else if (step.kind == 'C') {
        content_ +=
            fmt::format("{} {} {} c\n", point(step.x1, step.y1), point(step.x2, step.y2), point(step.x, step.y));
      } else {
        content_ += point(step.x, step.y) + (step.kind == 'M' ? " m\n" : " l\n");
      }
    }
    const bool fills = path.fill || path.ball;
    content_ += fills && strokes ? "B" : fills ? "f" : strokes ? "S" : "n";
    content_ += fills && path.even_odd ? "*\n" : "\n";
  }
  void add(const DrawnText& text) {
    const double width = text_width(text.text, text.size, text.bold);
    const double x = text.x - (text.anchor == Anchor::end ? width : text.anchor == Anchor::middle ? 0.5 * width : 0);
    content_ += fmt::format("BT /F{} {} Tf {} rg 1 0 0 1 {} Tm {} Tj ET\n", text.bold ? 2 : 1, number(text.size),
                            color(text.color.light), point(x, text.y), pdf_string(win_ansi(text.text)));
  }

  const Drawing& drawing_;
  std::string content_, patterns_;
  int ball_count_ = 0;
};

}  // namespace

std::string win_ansi(std::string_view text) {
  std::string bytes;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t length = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    std::uint32_t code = length == 1 ? first : first & (0xffu >> (length + 1));
    for (std::size_t k = 1; k < length && i + k < text.size(); ++k)
      code = (code << 6) | (static_cast<unsigned char>(text[i + k]) & 0x3fu);
    i += length;
    if (code < 0x80 || (code >= 0xa0 && code <= 0xff)) {
      bytes += static_cast<char>(code);
    } else if (code == 0x2212 || code == 0x2010) {  // minus, hyphen
      bytes += '-';
    } else if (code == 0x2013 || code == 0x2014) {  // dashes
      bytes += static_cast<char>(code - 0x2013 + 0x96);
    } else if (code == 0x2018 || code == 0x2019) {  // quotes
      bytes += static_cast<char>(code - 0x2018 + 0x91);
    } else if (code == 0x3bc) {  // the Greek letter instead of the unit's sign
      bytes += static_cast<char>(0xb5);
    } else {
      bytes += '?';
    }
  }
  return bytes;
}

std::string pdf_of(const Drawing& drawing) {
  return PdfWriter(drawing).text();
}

}  // namespace morula::toolbox
