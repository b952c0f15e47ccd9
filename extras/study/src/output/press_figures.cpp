// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Curves and the table of the presses.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <morula/study/figures.hpp>
#include <toolbox/numbers.hpp>

#include "output/tables.hpp"

namespace morula::study {

using namespace toolbox;

namespace {

using Value = std::function<std::optional<double>(const PressFigures&)>;

/// A measure of the spheres and one of the surfaces, or only one.
struct PressMeasure {
  std::string suffix, title, label, unit;
  Value surfaces;  // corrected value; the only value of a measure that concerns neither depth nor normals
  Value spheres;   // value of the spheres, or none
};

std::vector<PressMeasure> press_measures() {
  return {
      {"", "largest depth", "largest depth", "over the true one",
       [](const PressFigures& f) { return f.depth_surfaces; }, [](const PressFigures& f) { return f.depth_spheres; }},
      {"-normal", "normals", "normal error, median", "degrees", [](const PressFigures& f) { return f.normal_surfaces; },
       [](const PressFigures& f) { return f.normal_spheres; }},
      {"-net", "sum of normals", "error of the sum of normals", "degrees",
       [](const PressFigures& f) { return f.net_surfaces; }, [](const PressFigures& f) { return f.net_spheres; }},
      {"-lost", "lost crossings", "crossings in no contact", "%",
       [](const PressFigures& f) {
         return f.crossings > 0 ? std::optional(100 * static_cast<double>(f.lost) / static_cast<double>(f.crossings))
                                : std::nullopt;
       },
       nullptr}};
}

/// "100", "leaves": short, for axes.
std::vector<std::string> query_names(const Plan& plan) {
  std::vector<std::string> names;
  for (const PressQuery& query : press_queries(plan))
    names.push_back(query.budget ? fmt::format("{}", *query.budget) : query.name());
  return names;
}

struct PressCurve {
  std::string name;
  const PressCell* cell;
  std::string method{};  // in figures that compare generators
};

void add_press_group(const Plan& plan, const std::string& group, const std::string& about, Axis axis,
                     const std::vector<PressCurve>& curves, std::vector<Figure>& figures) {
  const std::size_t amount = plan.press_amounts.size() / 2;
  for (const PressMeasure& measure : press_measures()) {
    Figure figure;
    figure.id = group + measure.suffix;
    figure.group = group;
    figure.title = fmt::format("Contacts, {}: {}", measure.title, about);
    figure.motion = "press";
    figure.y_label = measure.label;
    figure.y_unit = measure.unit;
    figure.x_names = query_names(plan);
    const auto add = [&](const PressCurve& curve, const std::string& name, SeriesRole role, const Value& value) {
      Series series{name, role, {}, {}};
      series.rule = plan.press_rules[curve.cell->rule].name;
      series.method = curve.method;
      series.faint = role == SeriesRole::reference;
      for (const PressFigures& f : curve.cell->figures) {
        if (f.amount != amount || f.axis != axis) continue;
        series.x.push_back(static_cast<double>(f.query));
        series.y.push_back(value(f));
      }
      figure.series.push_back(std::move(series));
    };
    const SeriesRole role = measure.suffix == "-lost" ? SeriesRole::uncovered : SeriesRole::method;
    for (const PressCurve& curve : curves) add(curve, curve.name, role, measure.surfaces);
    if (measure.spheres)
      for (const PressCurve& curve : curves)
        add(curve, curve.name + ", spheres", SeriesRole::reference, measure.spheres);
    figures.push_back(std::move(figure));
  }
}

}  // namespace

std::vector<Figure> make_press_figures(const Plan& plan, const Result& result) {
  std::vector<Figure> figures;
  const std::string& body = plan.bodies.front().name;
  std::vector<const PressCell*> cells;  // cells of the first body
  for (const PressCell& cell : result.presses)
    if (plan.pressed(cell.source).body == 0 && plan.is_first_seed(plan.pressed(cell.source))) cells.push_back(&cell);
  const auto is_medial = [&](const PressCell* cell) { return plan.pressed(cell->source).named() == Method::medial; };
  const auto medial = std::find_if(cells.begin(), cells.end(), is_medial);
  const std::size_t chosen = medial != cells.end() ? (*medial)->source : cells.empty() ? 0 : cells.front()->source;
  std::vector<PressCurve> generators, rules;
  std::vector<Axis> axes;
  for (const PressCell* cell : cells) {
    const FollowRule& rule = plan.press_rules[cell->rule];
    if (rule.key() == RuleKey(Rule::exact))
      generators.push_back({plan.pressed(cell->source).method, cell, plan.pressed(cell->source).method});
    if (cell->source == chosen) rules.push_back({rule.title(), cell});
    for (const PressFigures& f : cell->figures)
      if (std::find(axes.begin(), axes.end(), f.axis) == axes.end()) axes.push_back(f.axis);
  }
  const std::string pressed = percent(plan.press_amounts[plan.press_amounts.size() / 2]);
  for (const Axis axis : axes) {
    const std::string along(name(axis));
    const std::string about = fmt::format("{}, pressed along {} by {}", body, along, pressed);
    if (!generators.empty())
      add_press_group(plan, "press-generators-" + along, about + ", generators", axis, generators, figures);
    add_press_group(plan, "press-rules-" + along, fmt::format("{}, rules, {}", about, plan.pressed(chosen).method),
                    axis, rules, figures);
  }
  return figures;
}

Table make_press_table(const Plan& plan, const Result& result) {
  Table table{"contacts",
              "Contacts of two bodies pressed together, against exact triangles",
              "Pressed: % of the diagonal at rest along the axis. Depths: the largest, over the true one. Normals: "
              "median and 90 % of the angles from the true ones, and the angle of their sum weighted by depth, in "
              "degrees. Kept: contacts whose corrected depth is not 0; corrected figures are theirs. Lost: pairs of "
              "crossing facets in no contact. Error bound: mean, % of the diagonal.",
              false,
              {"body",
               "method",
               "seed",
               "rule",
               "axis",
               "pressed, %",
               "true depth, %",
               "query",
               "pair tests",
               "contacts",
               "finished",
               "kept",
               "depth",
               "corrected",
               "normal",
               "90 %",
               "corrected normal",
               "90 %",
               "sum",
               "corrected sum",
               "crossings",
               "lost",
               "error bound, %"},
              {}};
  const std::vector<PressQuery> queries = press_queries(plan);
  for (const PressCell& cell : result.presses) {
    const Source& source = plan.pressed(cell.source);
    for (const PressFigures& f : cell.figures) {
      table.rows.push_back({plan.bodies[source.body].name,
                            source.method,
                            seed_value(source),
                            plan.press_rules[cell.rule].name,
                            std::string(name(f.axis)),
                            100 * plan.press_amounts[f.amount],
                            100 * f.true_depth,
                            queries[f.query].name(),
                            f.pair_tests,
                            f.contacts,
                            f.finished,
                            f.kept,
                            f.depth_spheres,
                            f.depth_surfaces,
                            value_of(f.normal_spheres),
                            value_of(f.normal_spheres_90),
                            value_of(f.normal_surfaces),
                            value_of(f.normal_surfaces_90),
                            value_of(f.net_spheres),
                            value_of(f.net_surfaces),
                            f.crossings,
                            f.lost,
                            100 * f.error_bound});
    }
  }
  return table;
}

}  // namespace morula::study
