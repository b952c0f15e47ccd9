// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Charts of the study: colors for all readers, one look for each rule, and the same content in every format.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <morula/geometry/sample_bodies.hpp>
#include <morula/study/study.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <toolbox/svg_plot.hpp>

namespace morula::study {
namespace {

using Channels = std::array<double, 3>;

/// Linear light of an sRGB color (IEC 61966-2-1).
Channels linear(std::uint32_t color) {
  Channels c{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double v = static_cast<double>((color >> (16 - 8 * k)) & 0xff) / 255;
    c[k] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  return c;
}

/// The ratio of WCAG 2.
double contrast(std::uint32_t a, std::uint32_t b) {
  const auto luminance = [](const Channels& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; };
  const double x = luminance(linear(a)) + 0.05, y = luminance(linear(b)) + 0.05;
  return std::max(x, y) / std::min(x, y);
}

using Matrix = std::array<Channels, 3>;

/// Linear light as people see it without one kind of cones: Machado, Oliveira and Fernandes 2009, severity 1.
constexpr Matrix all_cones{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Matrix protanopia{
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix deuteranopia{
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};

Channels times(const Matrix& m, const Channels& c) {
  Channels result{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t k = 0; k < 3; ++k) result[row] += m[row][k] * c[k];
  return result;
}

Channels cielab(Channels light) {
  for (double& c : light) c = std::clamp(c, 0.0, 1.0);
  constexpr Matrix xyz{
      {{0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}}};
  const Channels white = times(xyz, {1, 1, 1});
  Channels f = times(xyz, light);
  for (std::size_t k = 0; k < 3; ++k) {
    const double t = f[k] / white[k];
    f[k] = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
  }
  return {116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])};
}

TEST(StudyCharts, colors_stand_out_from_their_page) {
  for (const toolbox::Shade& shade : toolbox::palette) {
    EXPECT_GE(contrast(shade.light, toolbox::shades::page.light), 3) << std::hex << shade.light;
    EXPECT_GE(contrast(shade.light, 0xf7f6f3), 3) << std::hex << shade.light << " on the page of the study";
    EXPECT_GE(contrast(shade.dark, toolbox::shades::page.dark), 3) << std::hex << shade.dark;
    EXPECT_GE(contrast(shade.dark, 0x0e1115), 3) << std::hex << shade.dark << " on the page of the study";
  }
  EXPECT_NEAR(contrast(0xffffff, 0), 21, 1e-9);
}

TEST(StudyCharts, colors_differ_for_the_color_blind_too) {
  for (const Matrix& eye : {all_cones, protanopia, deuteranopia}) {
    for (const bool dark : {false, true}) {
      for (std::size_t a = 0; a < toolbox::palette.size(); ++a) {
        for (std::size_t b = 0; b < a; ++b) {
          const auto seen = [&](std::size_t k) {
            return cielab(times(eye, linear(dark ? toolbox::palette[k].dark : toolbox::palette[k].light)));
          };
          const Channels p = seen(a), q = seen(b);
          EXPECT_GE(std::hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]), 20) << a << ' ' << b << ' ' << dark;
        }
      }
    }
  }
}

/// Two levels and two motions of every rule on one tree, with numbers made up; Approach 2 leaves surface uncovered.
Study small_study() {
  Study study;
  Plan& plan = study.plan;
  plan.bodies = {{"limb", sample_body("limb", 4)}};
  plan.sources = sources_of(plan.bodies, {Method::medial, Method::grid});
  plan.motions = {{Stretch{}}, {Bend{}}};
  for (const RuleKey& key : all_rule_keys()) plan.rules.emplace_back(key);
  plan.samples = 3;
  plan.of_levels = {1, 2};
  for (std::size_t source = 0; source < 2; ++source) {
    for (std::size_t motion = 0; motion < 2; ++motion) {
      for (std::size_t rule = 0; rule < plan.rules.size(); ++rule) {
        MotionRun cell;
        cell.key = {source, motion, rule};
        for (std::size_t sample = 0; sample < 3; ++sample) {
          std::vector<LevelFigures> levels(2);
          for (std::size_t level = 0; level < 2; ++level) {
            levels[level].level = level + 1;
            levels[level].diagonal = levels[level].box_volume = 1;
            levels[level].grid.emplace().looseness =
                (1 + static_cast<double>(sample)) / (3 + static_cast<double>(rule + 2 * source + motion));
            if (plan.rules[rule].name == "approach2" && sample > 0)
              levels[level].coverage.uncovered_area = 0.125 * static_cast<double>(sample);
          }
          cell.samples.push_back({sample, 0.5 * static_cast<double>(sample), levels});
        }
        study.result.cells.push_back(cell);
      }
    }
  }
  study.figures = make_figures(plan, study.result);
  return study;
}

std::vector<std::string> matches(const std::string& text, const char* pattern) {
  const std::regex wanted(pattern);
  std::vector<std::string> list;
  for (std::sregex_iterator at(text.begin(), text.end(), wanted), end; at != end; ++at)
    list.push_back((*at)[at->size() > 1 ? 1 : 0]);
  return list;
}

TEST(StudyCharts, a_rule_has_one_look_in_all_figures_and_no_other_rule_has_it) {
  const Study study = small_study();
  std::map<std::string, std::set<std::string>> looks;
  for (const std::span<const Figure> group : groups_of(study.figures)) {
    if (group.front().series.front().method.empty()) {
      std::istringstream lines(figure_pgf(group));
      std::string name;
      for (std::string line; std::getline(lines, line);) {
        if (line.rfind("% ", 0) == 0) name = line.substr(2);
        if (line.rfind("\\addplot[morula", 0) != 0) continue;
        line = line.substr(0, line.find(']'));
        looks[name].insert(std::regex_replace(line, std::regex(",mark indices=[^,]*"), ""));
      }
    }
  }
  ASSERT_EQ(looks.size(), all_rule_keys().size());
  std::set<std::string> colors, marks, dashes;
  for (const auto& [name, look] : looks) {
    ASSERT_EQ(look.size(), 1u) << name;
    colors.insert(matches(*look.begin(), "(morula[0-9])").at(0));
    marks.insert(matches(*look.begin(), "mark=([^,]*.*)").at(0));
    dashes.insert(matches(*look.begin(), "(solid|dash pattern=[^,]*)").at(0) + (name == "fresh build" ? "points" : ""));
  }
  EXPECT_EQ(colors.size(), looks.size());
  EXPECT_EQ(marks.size(), looks.size());
  EXPECT_EQ(dashes.size(), looks.size());
}

/// Reads pgfplots text by its grammar: the coordinates of each drawn curve, without the helpers that hatch.
std::vector<std::vector<std::pair<std::string, std::string>>> pgf_curves(const std::string& text) {
  std::vector<std::vector<std::pair<std::string, std::string>>> curves;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("\\addplot[", 0) != 0 || line.find("forget plot") != std::string::npos) continue;
    EXPECT_EQ(line.substr(line.size() - 2), "};") << line;
    std::vector<std::pair<std::string, std::string>> curve;
    for (const std::string& point : matches(line.substr(line.find("coordinates {")), "\\(([^()]*)\\)"))
      curve.emplace_back(point.substr(0, point.find(',')), point.substr(point.find(',') + 1));
    curves.push_back(curve);
  }
  return curves;
}

TEST(StudyCharts, pgf_has_the_coordinates_of_the_csv) {
  const Study study = small_study();
  std::size_t curves_compared = 0;
  for (const std::span<const Figure> group : groups_of(study.figures)) {
    std::vector<std::vector<std::pair<std::string, std::string>>> expected;
    std::istringstream rows(figure_csv(group));
    std::string row, last;
    std::getline(rows, row);
    while (std::getline(rows, row)) {
      const std::size_t y = row.rfind(','), x = row.rfind(',', y - 1);
      if (row.substr(0, x) != last) expected.emplace_back();
      last = row.substr(0, x);
      expected.back().emplace_back(row.substr(x + 1, y - x - 1), y + 1 == row.size() ? "nan" : row.substr(y + 1));
    }
    const std::string text = figure_pgf(group);
    EXPECT_EQ(pgf_curves(text), expected) << group.front().group;
    curves_compared += expected.size();
    EXPECT_EQ(matches(text, "\\\\begin\\{").size(), matches(text, "\\\\end\\{").size());
    EXPECT_EQ(std::count(text.begin(), text.end(), '{'), std::count(text.begin(), text.end(), '}'));
    EXPECT_EQ(std::count(text.begin(), text.end(), '['), std::count(text.begin(), text.end(), ']'));
    EXPECT_NE(text.find("% Preamble: \\usepackage{pgfplots}"), std::string::npos);
    EXPECT_NE(text.find("legend cell align=left"), std::string::npos);
  }
  EXPECT_GT(curves_compared, 50u);
}

TEST(StudyCharts, hatch_is_where_surface_is_uncovered) {
  const Study study = small_study();
  std::size_t hatched = 0;
  for (const Figure& figure : study.figures) {
    for (const Series& series : figure.series) {
      for (std::size_t i = 0; i < series.uncovered.size(); ++i) {
        if (figure.y_label != "looseness") continue;
        EXPECT_EQ(series.uncovered[i], series.rule == "approach2" && i > 0) << figure.id << series.name << i;
      }
      hatched += std::count(series.uncovered.begin(), series.uncovered.end(), true) > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(hatched, 0u);
  EXPECT_NE(figure_svg(groups_of(study.figures).front()).find("leaves surface uncovered"), std::string::npos);
}

/// Offsets in the table of a PDF lead to its objects, and the length of its stream is that of its content.
void expect_sound_pdf(const std::string& pdf) {
  EXPECT_EQ(pdf.rfind("%PDF-1.", 0), 0u);
  EXPECT_EQ(pdf.substr(pdf.size() - 6), "%%EOF\n");
  const std::size_t start = std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10));
  std::istringstream table(pdf.substr(start));
  std::string word;
  std::size_t first = 0, count = 0;
  table >> word >> first >> count;
  ASSERT_EQ(word, "xref");
  ASSERT_EQ(first, 0u);
  for (std::size_t object = 0; object < count; ++object) {
    std::string offset, generation, kind;
    table >> offset >> generation >> kind;
    ASSERT_EQ(offset.size(), 10u);
    if (object == 0) continue;
    EXPECT_EQ(kind, "n");
    EXPECT_EQ(pdf.substr(std::stoul(offset)).rfind(std::to_string(object) + " 0 obj\n", 0), 0u) << object;
  }
  const std::size_t length = std::stoul(pdf.substr(pdf.find("/Length ") + 8));
  const std::size_t begin = pdf.find("stream\n") + 7;
  EXPECT_EQ(pdf.substr(begin + length, 9), "endstream");
}

TEST(StudyCharts, pdf_has_the_paths_and_texts_of_the_svg) {
  const Study study = small_study();
  for (const std::span<const Figure> group : groups_of(study.figures)) {
    const std::string svg = figure_svg(group), pdf = figure_pdf(group);
    expect_sound_pdf(pdf);
    std::istringstream lines(pdf);
    std::size_t paths = 0, texts = 0;
    for (std::string line; std::getline(lines, line);) {
      paths += std::set<std::string>{"S", "f", "f*", "B", "B*"}.count(line);
      texts += line.rfind("BT ", 0) == 0 ? 1 : 0;
    }
    EXPECT_EQ(paths, matches(svg, "<path ").size()) << group.front().group;
    EXPECT_EQ(texts, matches(svg, "<text ").size()) << group.front().group;
    EXPECT_EQ(pdf.find("nan"), std::string::npos);
  }
}

TEST(StudyCharts, pictures_are_pdf_too) {
  toolbox::Drawing drawing{.width = 100, .height = 50, .title = "a (small) one"};
  toolbox::DrawnPath path;
  path.steps = {{'M', 10, 10}, {'L', 20, 10}, {'L', 20, 20}, {'Z'}};
  path.ball = toolbox::Ball{15, 15, 5, 13, 13};
  drawing.items.emplace_back(path);
  drawing.items.emplace_back(toolbox::DrawnText{.x = 5, .y = 6, .text = "90° − 2 × µm (b) π"});
  const std::string pdf = toolbox::pdf_of(drawing);
  expect_sound_pdf(pdf);
  EXPECT_NE(pdf.find("/Title (a \\(small\\) one)"), std::string::npos);
  EXPECT_NE(pdf.find("(90\\260 - 2 \\327 \\265m \\(b\\) ?) Tj"), std::string::npos) << pdf;
  EXPECT_NE(pdf.find("/Coords [13 37 0 15 35 5]"), std::string::npos) << "y points up";
}

TEST(StudyCharts, a_long_legend_and_a_long_title_stay_on_the_page) {
  toolbox::Plot plot{.title = std::string(300, 'W'), .x_label = "x", .panels = {{"y", {}}}};
  for (int k = 0; k < 30; ++k)
    plot.panels[0].lines.push_back({.name = "a line with a name of some length, " + std::to_string(k),
                                    .x = {0, 1},
                                    .y = {0.0, static_cast<double>(k)}});
  const toolbox::Drawing drawing = toolbox::plot_drawing(plot);
  std::set<double> rows;
  for (const auto& item : drawing.items) {
    const auto* text = std::get_if<toolbox::DrawnText>(&item);
    if (text == nullptr || text->anchor != toolbox::Anchor::start) continue;
    const bool wide = text->text.find('W') != std::string::npos;  // 0.94 of the size each
    EXPECT_LE(text->x + static_cast<double>(text->text.size()) * text->size * (wide ? 0.94 : 0.5), drawing.width);
    if (text->text.rfind("a line", 0) == 0) rows.insert(text->y);
  }
  EXPECT_GE(rows.size(), 10u);
}

TEST(StudyCharts, the_summary_is_made_from_claims_and_cells) {
  Study study = small_study();
  study.claims = {{.id = "approach2-largely-better",
                   .origin = ClaimOrigin::paper,
                   .claim = "Two is better",
                   .verdict = Verdict::holds},
                  {.id = "b", .origin = ClaimOrigin::paper, .claim = "Something", .verdict = Verdict::fails}};
  const std::vector<std::string> text = summary_of(study);
  ASSERT_EQ(text.size(), 3u);
  EXPECT_EQ(text[0], "The paper makes 2 claims, among them “Two is better”.");
  EXPECT_EQ(text[1], "On limb 1 holds and 1 fails.");
  // Approach 2 is the rule number 3, exact number 4: sums over trees and motions of 1 / (3 + rule + 2 source + motion).
  double two = 0, exact = 0;
  for (const int step : {0, 1, 2, 3}) two += 1.0 / (6 + step), exact += 1.0 / (7 + step);
  std::ostringstream ratio;
  ratio.precision(3);
  ratio << exact / two;
  EXPECT_EQ(
      text[2].find("Looseness alone rewards rules that leave surface uncovered: Approach 2 is the tightest of them "
                   "and leaves up to 25.0% of the surface uncovered; exact leaves nothing uncovered, at " +
                   ratio.str() + " times its mean looseness"),
      0u)
      << text[2];
}

}  // namespace
}  // namespace morula::study
