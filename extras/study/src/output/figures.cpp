// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <morula/study/figures.hpp>

#include "words.hpp"

namespace morula::study {
namespace {

using Measure = std::function<std::optional<double>(const LevelFigures&)>;

struct MeasureKind {
  std::string suffix;
  std::string title;
  std::string label;
  std::string unit;
  bool uncovered;
  Measure value;
};

std::vector<MeasureKind> measures(const Plan& plan) {
  const ErrorUnit unit = plan.unit;
  std::vector<MeasureKind> list{
      {"", "looseness", error_label(unit), error_unit(unit), false,
       [unit](const LevelFigures& l) { return l.error(unit); }},
      {"-uncovered", "uncovered area", "uncovered area", "% of the surface", true,
       [](const LevelFigures& l) { return std::optional(100 * l.uncovered_area()); }},
      {"-uncovered-distance", "uncovered distance", "uncovered distance", "% of the diagonal at rest", true,
       [](const LevelFigures& l) { return std::optional(100 * l.uncovered_distance()); }},
      {"-protrusion", "protrusion", "mean protrusion", "% of the diagonal at rest", false,
       [](const LevelFigures& l) { return l.protrusion ? std::optional(100 * *l.protrusion_mean()) : std::nullopt; }}};
  for (std::size_t i = 0; i < plan.metrics.size(); ++i) {
    const OwnMetric& metric = plan.metrics[i];
    list.push_back({"-" + metric.name, metric.name, metric.name, metric.unit, false,
                    [i](const LevelFigures& l) { return i < l.metrics.size() ? l.metrics[i] : std::nullopt; }});
  }
  return list;
}

/// One curve of a figure: its source, its name and its part.
struct Curve {
  std::size_t source;
  std::optional<std::size_t> rule;
  std::string name;
  SeriesRole role;
  bool of_generators = false;  // its figure compares generators
};

/// "Fig. 2 a. Uncovered area: rules, medial, level 2, stretch 2": one line, the measure in the middle.
std::string figure_title(const std::string& head, const std::string& measure, const std::string& about) {
  std::string text = head.empty() ? measure : head + ". " + measure;
  const std::size_t first = text.size() - measure.size();
  text[first] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[first])));
  return text + ": " + about;
}

/// Looseness, uncovered area, uncovered distance and protrusion of the same curves.
void add_group(const Plan& plan, const Result& result, const std::string& group, const std::string& head,
               const std::string& about, std::size_t motion, std::size_t level, const std::vector<Curve>& curves,
               std::vector<Figure>& figures) {
  for (const MeasureKind& kind : measures(plan)) {
    Figure figure;
    figure.id = group + kind.suffix;
    figure.group = group;
    figure.title = figure_title(head, kind.title, about);
    figure.motion = first_word(plan.motion_name(motion));
    figure.y_label = kind.label;
    figure.y_unit = kind.unit;
    bool known = false;
    for (const Curve& curve : curves) {
      const MotionRun* cell = curve.rule ? result.find({curve.source, motion, *curve.rule}) : nullptr;
      if (cell == nullptr) continue;
      Series series{
          curve.name, kind.uncovered && curve.role == SeriesRole::method ? SeriesRole::uncovered : curve.role, {}, {}};
      series.rule = plan.rules[*curve.rule].name;
      if (curve.of_generators) series.method = plan.sources[curve.source].method;
      for (const Sample& sample : cell->samples) {
        const LevelFigures* figures_of_level = cell->at(sample.sample, level);
        if (figures_of_level == nullptr) continue;
        series.x.push_back(static_cast<double>(sample.sample));
        series.y.push_back(kind.value(*figures_of_level));
        series.uncovered.push_back(!kind.uncovered && figures_of_level->uncovered_area() > 0);
        known = known || series.y.back().has_value();
      }
      figure.series.push_back(std::move(series));
    }
    if (known) figures.push_back(std::move(figure));
  }
}

/// Approach 1 and 2 as the curves of the figure, and behind them the other rules.
std::vector<Curve> rule_curves(const Plan& plan, std::size_t source) {
  std::vector<Curve> curves;
  const std::array paper{plan.find_rule(Rule::approach1), plan.find_rule(Rule::approach2)};
  for (const std::optional<std::size_t>& rule : paper)
    if (rule) curves.push_back({source, rule, plan.rules[*rule].title(), SeriesRole::method});
  for (std::size_t rule = 0; rule < plan.rules.size(); ++rule) {
    if (std::find(paper.begin(), paper.end(), rule) != paper.end()) continue;
    const SeriesRole role = plan.rules[rule].own ? SeriesRole::method : SeriesRole::reference;
    curves.push_back({source, rule, plan.rules[rule].title(), role});
  }
  return curves;
}

std::vector<std::size_t> sources_of_first_trial(const Plan& plan) {
  return plan.sources_of(plan.trials().front());
}

}  // namespace

std::string_view name(SeriesRole role) {
  return role == SeriesRole::method ? "method" : role == SeriesRole::reference ? "reference" : "uncovered";
}

std::string error_label(ErrorUnit unit) {
  return unit == ErrorUnit::volume ? "looseness" : "outside volume";
}

std::string error_unit(ErrorUnit unit) {
  return unit == ErrorUnit::volume ? "object volumes" : "boxes of the object at rest";
}

std::vector<Figure> make_figures(const Plan& plan, const Result& result) {
  std::vector<Figure> figures;
  const std::size_t medial = shown_tree(plan);
  const std::string& medial_name = plan.sources[medial].method;
  const std::vector<std::size_t> sources = sources_of_first_trial(plan);
  const std::vector<std::size_t> levels = plan.levels();
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (std::size_t motion = 0; motion < plan.motion_count(); ++motion) {
      const std::string words = plan.motion_name(motion);
      const bool stretch = first_word(words) == "stretch";
      const std::string part = i + 1 == levels.size() ? "b" : "a";
      const std::string id =
          stretch ? "fig2" + part : fmt::format("rules-{}-{}-{}", medial_name, first_word(words), levels[i]);
      add_group(plan, result, id, stretch ? "Fig. 2 " + part : "",
                fmt::format("rules, {}, level {}, {}", medial_name, levels[i], words), motion, levels[i],
                rule_curves(plan, medial), figures);
    }
  }
  const std::optional<std::size_t> approach2 = plan.find_rule(Rule::approach2), exact = plan.find_rule(Rule::exact);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    for (std::size_t motion = 0; motion < plan.motion_count(); ++motion) {
      const std::string words = plan.motion_name(motion);
      const std::string part = i + 1 == levels.size() ? "d" : "c";
      std::vector<Curve> curves;
      for (const std::size_t source : sources) {
        const bool ours = plan.sources[source].named() == Method::optimized;
        curves.push_back(
            {source, approach2, plan.sources[source].method, ours ? SeriesRole::reference : SeriesRole::method, true});
      }
      for (const std::size_t source : sources)
        curves.push_back({source, exact, plan.sources[source].method + ", exact", SeriesRole::reference, true});
      add_group(plan, result, fmt::format("fig2{}-{}", part, first_word(words)), "Fig. 2 " + part,
                fmt::format("generators, level {}, {}", levels[i], words), motion, levels[i], curves, figures);
    }
  }
  for (const std::size_t source : sources) {
    if (source == medial) continue;
    const std::string& method = plan.sources[source].method;
    for (const std::size_t level : levels) {
      for (std::size_t motion = 0; motion < plan.motion_count(); ++motion) {
        const std::string words = plan.motion_name(motion);
        add_group(plan, result, fmt::format("rules-{}-{}-{}", method, first_word(words), level), "",
                  fmt::format("rules, {}, level {}, {}", method, level, words), motion, level,
                  rule_curves(plan, source), figures);
      }
    }
  }
  return figures;
}

}  // namespace morula::study
