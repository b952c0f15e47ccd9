// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

namespace morula::cli {
namespace {

using Measure = std::function<std::optional<double>(const StudyLevel&)>;

struct MeasureKind {
  std::string suffix;
  std::string title;
  std::string label;
  std::string unit;
  bool bare;
  Measure value;
};

std::vector<MeasureKind> measures(ErrorUnit unit) {
  return {{"", "looseness", error_label(unit), error_unit(unit), false,
           [unit](const StudyLevel& l) { return l.error(unit); }},
          {"-bare", "bare area", "bare area", "% of the surface", true,
           [](const StudyLevel& l) { return std::optional(100 * l.bare_area); }},
          {"-gap", "gap", "gap", "% of the diagonal at rest", true,
           [](const StudyLevel& l) { return std::optional(100 * l.gap); }},
          {"-protrusion", "protrusion", "mean protrusion", "% of the diagonal at rest", false, [](const StudyLevel& l) {
             return l.protrusion_mean ? std::optional(100 * *l.protrusion_mean) : std::nullopt;
           }}};
}

/// One curve of a figure: whose, called what, and in which part.
struct Curve {
  std::string method;
  std::string rule;
  std::string name;
  SeriesRole role;
};

/// Looseness, bare area, gap and protrusion of the same curves.
void add_group(const StudyPlan& plan, const StudyResult& result, const std::string& group, const std::string& title,
               const std::string& motion, std::size_t level, const std::vector<Curve>& curves,
               std::vector<StudyFigure>& figures) {
  for (const MeasureKind& kind : measures(plan.unit)) {
    StudyFigure figure;
    figure.id = group + kind.suffix;
    figure.group = group;
    figure.title = kind.suffix.empty() ? title : fmt::format("{}: {}", title, kind.title);
    figure.motion = first_word(motion);
    figure.body = plan.bodies.front().name;
    figure.y_label = kind.label;
    figure.y_unit = kind.unit;
    bool known = false;
    for (const Curve& curve : curves) {
      const StudyCell* cell = result.find(figure.body, curve.method, motion, curve.rule);
      if (cell == nullptr) continue;
      StudySeries series{
          curve.name, kind.bare && curve.role == SeriesRole::method ? SeriesRole::bare : curve.role, {}, {}};
      for (const StudySample& sample : cell->samples) {
        const StudyLevel* figures_of_level = cell->at(sample.sample, level);
        if (figures_of_level == nullptr) continue;
        series.x.push_back(static_cast<double>(sample.sample));
        series.y.push_back(kind.value(*figures_of_level));
        known = known || series.y.back().has_value();
      }
      figure.series.push_back(std::move(series));
    }
    if (known) figures.push_back(std::move(figure));
  }
}

std::vector<Curve> rule_curves(const StudyPlan& plan, const std::string& method, bool paper_rules_first) {
  std::vector<Curve> curves;
  const auto add = [&](const std::string& rule, SeriesRole role) {
    if (plan.has_rule(rule)) curves.push_back({method, rule, rule_title(rule), role});
  };
  if (paper_rules_first) {
    add("approach1", SeriesRole::method);
    add("approach2", SeriesRole::method);
  }
  for (const StudyRule& rule : plan.rules) {
    const bool is_paper = rule.name == "approach1" || rule.name == "approach2";
    if (is_paper && paper_rules_first) continue;
    add(rule.name, paper_rules_first ? SeriesRole::reference : SeriesRole::method);
  }
  return curves;
}

std::string main_method(const StudyPlan& plan) {
  return plan.has_method("medial") ? "medial" : plan.sources.front().method;
}

std::vector<std::string> methods_of_first_body(const StudyPlan& plan) {
  std::vector<std::string> methods;
  for (const StudySource& source : plan.sources)
    if (source.body == 0) methods.push_back(source.method);
  return methods;
}

}  // namespace

std::string_view name(SeriesRole role) {
  return role == SeriesRole::method ? "method" : role == SeriesRole::reference ? "reference" : "bare";
}

std::string rule_title(const std::string& rule) {
  if (rule == "approach1") return "Approach 1";
  if (rule == "approach2") return "Approach 2";
  if (rule == "refitted") return "exact, re-fitted";
  if (rule == "fresh") return "fresh build";
  return rule;
}

std::string first_word(const std::string& text) {
  return text.substr(0, text.find(' '));
}

std::string error_label(ErrorUnit unit) {
  return unit == ErrorUnit::volume ? "looseness" : "outside volume";
}

std::string error_unit(ErrorUnit unit) {
  return unit == ErrorUnit::volume ? "object volumes" : "boxes of the object at rest";
}

std::vector<StudyFigure> make_figures(const StudyPlan& plan, const StudyResult& result) {
  std::vector<StudyFigure> figures;
  const std::string medial = main_method(plan);
  const std::vector<std::string> methods = methods_of_first_body(plan);
  const std::vector<std::size_t> levels = plan.levels();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const Deformations& motion : plan.motions) {
      const std::string words = describe_all(motion);
      const bool stretch = first_word(words) == "stretch";
      const std::string part = i + 1 == levels.size() ? "b" : "a";
      const std::string id =
          stretch ? "fig2" + part : fmt::format("rules-{}-{}-{}", medial, first_word(words), levels[i]);
      add_group(plan, result, id,
                fmt::format("{}Approach 1 and Approach 2, {} tree, level {}, {}",
                            stretch ? fmt::format("Fig. 2 {}. ", part) : "", medial, levels[i], words),
                words, levels[i], rule_curves(plan, medial, true), figures);
    }
  }
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (const Deformations& motion : plan.motions) {
      const std::string words = describe_all(motion);
      const std::string part = i + 1 == levels.size() ? "d" : "c";
      std::vector<Curve> curves;
      for (const std::string& method : methods) {
        const bool ours = method == "morula";
        curves.push_back({method, "approach2", method, ours ? SeriesRole::reference : SeriesRole::method});
      }
      for (const std::string& method : methods)
        curves.push_back({method, "exact", method + ", exact", SeriesRole::reference});
      add_group(plan, result, fmt::format("fig2{}-{}", part, first_word(words)),
                fmt::format("Fig. 2 {}. Generators with Approach 2, level {}, {}", part, levels[i], words), words,
                levels[i], curves, figures);
    }
  }
  for (const std::string& method : methods) {
    if (method == medial) continue;
    for (const std::size_t level : levels) {
      for (const Deformations& motion : plan.motions) {
        const std::string words = describe_all(motion);
        add_group(plan, result, fmt::format("rules-{}-{}-{}", method, first_word(words), level),
                  fmt::format("Every rule, {} tree, level {}, {}", method, level, words), words, level,
                  rule_curves(plan, method, true), figures);
      }
    }
  }
  return figures;
}

Json figure_json(const StudyFigure& figure) {
  Json series = Json::array();
  for (const StudySeries& s : figure.series) {
    Json y = Json::array();
    for (const std::optional<double>& value : s.y) y.push_back(value ? Json(*value) : Json(nullptr));
    series.push_back({{"name", s.name}, {"x", s.x}, {"y", y}, {"role", name(s.role)}});
  }
  Json json{{"id", figure.id}, {"title", figure.title}};
  if (!figure.note.empty()) json["note"] = figure.note;
  if (figure.x_names.empty()) {
    json["x"] = {{"label", "sample"}, {"unit", "of the motion"}};
  } else {
    json["x"] = {{"label", "query"}, {"unit", "contacts"}, {"names", figure.x_names}};
  }
  json["y"] = {{"label", figure.y_label}, {"unit", figure.y_unit}};
  if (figure.y_log) json["y"]["log"] = true;
  json["frame_axis"] = figure.x_names.empty();
  json["motion"] = figure.motion;
  json["body"] = figure.body;
  json["series"] = series;
  return json;
}

Json table_json(const StudyTable& table) {
  Json rows = Json::array();
  for (const std::vector<Json>& row : table.rows) rows.push_back(row);
  Json json{{"id", table.id}, {"title", table.title}, {"note", table.note}};
  if (table.timed) json["timed"] = true;
  json["columns"] = table.columns;
  json["rows"] = rows;
  return json;
}

}  // namespace morula::cli
