// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "output/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/update/body.hpp>
#include <stdexcept>

#include "output/styles.hpp"
#include "run/poses.hpp"
#include "svg/picture.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

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
  std::vector<MovedFrames> motions = move_frames(plan, 0, end, nullptr);
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

/// The boxes of all contents: rows × columns, in units of the mesh; and what they take on the page.
struct Layout {
  std::vector<std::vector<PictureBox>> boxes;
  std::vector<double> widths, heights;
};

Layout layout_of(const std::vector<Row>& rows, const std::vector<Column>& columns, const PictureView& view) {
  Layout layout{std::vector<std::vector<PictureBox>>(rows.size()), {}, std::vector<double>(rows.size(), 0)};
  for (const Column& column : columns) {
    double width = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const PictureBox box = picture_box(view, column.positions, spheres_of(column, rows[r]));
      layout.boxes[r].push_back(box);
      width = std::max(width, box.x1 - box.x0);
      layout.heights[r] = std::max(layout.heights[r], box.y1 - box.y0);
    }
    layout.widths.push_back(width);
  }
  return layout;
}

void add_text(Drawing& drawing, double x, double y, const std::string& text, Shade color, Anchor anchor) {
  drawing.items.emplace_back(DrawnText{x, y, text, color, 16, anchor});
}

/// One row: its name, and its contents in each pose. Returns its lower end.
double draw_row(const Mesh& rest, const std::vector<Row>& rows, std::size_t r, const std::vector<Column>& columns,
                const Layout& layout, PictureView view, double y, Drawing& drawing) {
  std::vector<std::uint32_t> kept;
  Mesh shown = coarser(rest, most_facets, kept);
  const double height = view.scale * layout.heights[r];
  add_text(drawing, 12, y + 0.5 * height, rows[r].first_line, shades::ink, Anchor::start);
  if (!rows[r].second_line.empty())
    add_text(drawing, 12, y + 0.5 * height + 20, rows[r].second_line, shades::muted, Anchor::start);
  double x = left;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double width = view.scale * layout.widths[c];
    const PictureBox& box = layout.boxes[r][c];
    view.page_x = x + 0.5 * width - 0.5 * view.scale * (box.x0 + box.x1);
    view.page_y = y + 0.5 * height - 0.5 * view.scale * (box.y0 + box.y1);
    if (r == 0) {
      add_text(drawing, x + 0.5 * width, top - 22, columns[c].name, shades::ink, Anchor::middle);
      for (std::size_t v = 0; v < kept.size(); ++v) shown.positions[v] = columns[c].positions[kept[v]];
      draw_mesh(shown, view, drawing);
    } else {
      draw_spheres({columns[c].positions, rest.facets}, spheres_of(columns[c], rows[r]), view, drawing);
    }
    x += width + between;
  }
  return y + height;
}

/// Levels and budgets do not form one sequence: a gap between them.
void part_levels_from_budgets(const std::vector<std::string>& names, PlotLine& line) {
  for (std::size_t i = 1; i < names.size() && i < line.x.size(); ++i) {
    if (names[i - 1].rfind("level", 0) != 0 || names[i].rfind("level", 0) == 0) continue;
    line.x.insert(line.x.begin() + static_cast<std::ptrdiff_t>(i), static_cast<double>(i) - 0.5);
    line.y.insert(line.y.begin() + static_cast<std::ptrdiff_t>(i), std::nullopt);
    return;
  }
}

}  // namespace

Plot plot_of(std::span<const Figure> group) {
  const Figure& first = group.front();
  Plot plot{first.title, fmt::format("sample (0 is rest, the last one the full {})", first.motion), {}};
  plot.hatch_name = "hatched: the rule leaves surface uncovered";
  if (!first.x_names.empty()) {
    plot.x_label = "how far the query goes: a level, leaves with a budget of pair tests, all leaves";
    plot.x_names = first.x_names;
  }
  for (const Figure& figure : group) {
    PlotPanel panel{fmt::format("{}, {}", figure.y_label, figure.y_unit), {}, figure.y_end};
    for (const Series& s : figure.series) {
      PlotLine line = style_of(s);
      line.x = s.x;
      line.y = s.y;
      line.hatched = s.uncovered;
      part_levels_from_budgets(first.x_names, line);
      panel.lines.push_back(std::move(line));
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

std::vector<Picture> make_pictures(const Plan& plan, const Result& result) {
  const std::vector<Column> columns = make_columns(plan, result);
  if (columns.empty()) return {};
  const Mesh& rest = plan.bodies.front().mesh;
  const std::vector<Row> rows = make_rows(plan);
  // One scale for all; the width of a column and the height of a row are those of their contents.
  PictureView view = side_view(bounding_box(rest).longest_axis());
  const Layout layout = layout_of(rows, columns, view);
  double total = 0;
  for (const double width : layout.widths) total += width;
  view.scale = (page_width - left - between * static_cast<double>(columns.size())) / total;
  Drawing drawing{.width = page_width, .height = 0, .title = "Fig. 1. The body, and the spheres that follow it"};
  double y = top;
  for (std::size_t r = 0; r < rows.size(); ++r) y = draw_row(rest, rows, r, columns, layout, view, y, drawing) + 26;
  DrawnPath square;
  square.steps = {{'M', 12, y - 12}, {'L', 24, y - 12}, {'L', 24, y}, {'L', 12, y}, {'Z'}};
  square.fill = uncovered_shade;
  drawing.items.emplace_back(square);
  add_text(drawing, 30, y - 1, "surface in front of all spheres: uncovered", shades::muted, Anchor::start);
  drawing.height = y + 14;
  return {{"fig1",
           fmt::format("Fig. 1. {}: its poses, and the spheres of Approach 2 and exact", plan.bodies.front().name),
           svg_of(drawing), pdf_of(drawing)}};
}

}  // namespace morula::study
