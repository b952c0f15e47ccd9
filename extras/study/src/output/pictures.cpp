// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "output/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/update/body.hpp>
#include <stdexcept>

#include "run/poses.hpp"
#include "svg/picture.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

/// The color of a curve: the same for one rule, or one generator, in all plots.
int color_of(const std::string& series) {
  static const std::vector<std::pair<std::string, int>> colors{
      {"Approach 1", 1},  {"Approach 2", 0}, {"traditional", 4}, {"weighted", 6}, {"exact, rebuilt", 5},
      {"fresh build", 7}, {"exact", 2},      {"medial", 0},      {"grid", 2},     {"hubbard", 1},
      {"spawn", 3},       {"optimized", 7},  {"octree", 4}};
  for (const auto& [begin, color] : colors)
    if (series.rfind(begin, 0) == 0) return color;
  return 7;
}

constexpr double page_width = 1080;
constexpr double left = 120;  // room for the names of rows
constexpr double between = 22;
constexpr double top = 52;
constexpr std::size_t most_facets = 7000;

/// One pose, and the spheres of each rule in it.
struct Column {
  std::string name;
  std::vector<Vec3> positions;
  SphereTree approach2, exact;
};

struct Row {
  std::string first_line, second_line;
  std::size_t level;
  Rule rule;
  bool spheres;
};

std::vector<Row> make_rows(const Plan& plan) {
  std::vector<Row> rows{{"the body", "", 0, Rule::approach2, false}};
  for (const std::size_t level : plan.levels())
    rows.push_back({"Approach 2", fmt::format("level {}", level), level, Rule::approach2, true});
  rows.push_back({"exact", fmt::format("level {}", plan.levels().back()), plan.levels().back(), Rule::exact, true});
  return rows;
}

std::vector<Sphere> spheres_of(const Column& column, const Row& row) {
  if (!row.spheres) return {};
  const SphereTree& tree = row.rule == Rule::exact ? column.exact : column.approach2;
  return level_set_spheres(tree, std::min(row.level, tree.level_count() - 1));
}

/// The motions in the paper's order, the last one first, and rest.
std::vector<Column> make_columns(const Plan& plan, const Result& result) {
  const NamedMesh& body = plan.bodies.front();
  const std::vector<double> end{1.0};
  std::vector<MovedFrames> motions = move_frames(plan, 0, plan.motions, end, nullptr);
  std::reverse(motions.begin(), motions.end());
  motions.push_back({0, "at rest", {body.mesh.positions}});
  const CoveredTree& model = result.model[shown_tree(plan)];
  Body second(body.mesh, model, {.rules = {Rule::approach2}, .details = {}, .modes = {}});
  Body exact(body.mesh, model, {.rules = {Rule::exact}, .details = {}, .modes = {}});
  std::vector<Column> columns;
  for (MovedFrames& motion : motions) {
    const std::vector<Vec3>& positions = motion.frames.front();
    if (!second.update(positions) || !exact.update(positions))
      throw std::logic_error("the study's own motion was rejected by update");
    columns.push_back({motion.name, positions, second.current_tree(), exact.current_tree()});
  }
  return columns;
}

}  // namespace

Plot plot_of(std::span<const Figure> group) {
  const Figure& first = group.front();
  Plot plot{first.title, fmt::format("sample (0 is rest, the last one the full {})", first.motion), {}};
  if (!first.x_names.empty()) {
    plot.x_label = "how far the query goes: a level, leaves with a budget of pair tests, all leaves";
    plot.x_names = first.x_names;
  }
  for (const Figure& figure : group) {
    PlotPanel panel{fmt::format("{}, {}", figure.y_label, figure.y_unit), {}, figure.y_end};
    for (const Series& s : figure.series) {
      PlotLine line{s.name, s.x, s.y, color_of(s.name), PlotLine::Style::solid, s.role != SeriesRole::reference};
      // Levels and budgets do not form one sequence.
      for (std::size_t i = 1; i < first.x_names.size() && i < line.x.size(); ++i) {
        if (first.x_names[i - 1].rfind("level", 0) != 0 || first.x_names[i].rfind("level", 0) == 0) continue;
        line.x.insert(line.x.begin() + static_cast<std::ptrdiff_t>(i), static_cast<double>(i) - 0.5);
        line.y.insert(line.y.begin() + static_cast<std::ptrdiff_t>(i), std::nullopt);
        break;
      }
      if (s.name.find("fresh") != std::string::npos) {
        line.style = PlotLine::Style::dots;
      } else if (!line.strong && s.name != "optimized") {
        line.style = PlotLine::Style::dashed;
      }
      panel.lines.push_back(std::move(line));
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

std::vector<Picture> make_pictures(const Plan& plan, const Result& result) {
  std::vector<Column> columns = make_columns(plan, result);
  if (columns.empty()) return {};
  const Mesh& rest = plan.bodies.front().mesh;
  std::vector<std::uint32_t> kept;
  Mesh shown = coarser(rest, most_facets, kept);
  const std::vector<Row> rows = make_rows(plan);

  // One scale for all; the width of a column and the height of a row are those of their contents.
  PictureView view = side_view(bounding_box(rest).longest_axis());
  std::vector<double> widths, heights(rows.size(), 0);
  std::vector<std::vector<PictureBox>> boxes(rows.size());
  double total = 0;
  for (const Column& column : columns) {
    double width = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      boxes[r].push_back(picture_box(view, column.positions, spheres_of(column, rows[r])));
      const PictureBox& box = boxes[r].back();
      width = std::max(width, box.x1 - box.x0);
      heights[r] = std::max(heights[r], box.y1 - box.y0);
    }
    widths.push_back(width);
    total += width;
  }
  view.scale = (page_width - left - between * static_cast<double>(columns.size())) / total;
  std::string body = svg_sphere_definitions("f1");
  double y = top;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double height = view.scale * heights[r];
    body += fmt::format("<text x=\"12\" y=\"{:.1f}\">{}</text>", y + 0.5 * height, svg_escaped(rows[r].first_line));
    body += fmt::format("<text class=\"t\" x=\"12\" y=\"{:.1f}\">{}</text>\n", y + 0.5 * height + 16,
                        svg_escaped(rows[r].second_line));
    double x = left;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double width = view.scale * widths[c];
      const PictureBox& box = boxes[r][c];
      view.page_x = x + 0.5 * width - 0.5 * view.scale * (box.x0 + box.x1);
      view.page_y = y + 0.5 * height - 0.5 * view.scale * (box.y0 + box.y1);
      if (r == 0) {
        body += fmt::format("<text text-anchor=\"middle\" x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n", x + 0.5 * width,
                            top - 22, svg_escaped(columns[c].name));
        for (std::size_t v = 0; v < kept.size(); ++v) shown.positions[v] = columns[c].positions[kept[v]];
        body += svg_mesh(shown, view);
      } else {
        body += svg_spheres({columns[c].positions, rest.facets}, spheres_of(columns[c], rows[r]), view,
                            fmt::format("f1-{}{}-", r, c));
      }
      x += width + between;
    }
    y += height + 26;
  }
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" "
      "height=\"{1:.0f}\" role=\"img\" font-family=\"system-ui,Helvetica,Arial,sans-serif\" font-size=\"13\">\n"
      "<title>{2}</title>\n<style>text{{fill:#222}}.t{{fill:#555}}.p{{fill:#fff}}@media(prefers-color-scheme:dark)"
      "{{text{{fill:#e8e8e8}}.t{{fill:#aaa}}.p{{fill:#16181c}}}}</style>\n"
      "<rect class=\"p\" width=\"100%\" height=\"100%\"/>\n",
      page_width, y + 14, "Fig. 1. The body, and the spheres that follow it");
  svg += body;
  svg += fmt::format(
      "<path fill=\"#d55e00\" d=\"M12 {0:.1f}h12v12h-12z\"/><text class=\"t\" x=\"30\" y=\"{1:.1f}\">surface in front "
      "of all spheres: bare</text>\n</svg>\n",
      y - 12, y - 1);
  return {{"fig1",
           fmt::format("Fig. 1. {}, bent, twisted, stretched and at rest; the spheres of Approach 2, and of exact",
                       plan.bodies.front().name),
           svg}};
}

}  // namespace morula::study
