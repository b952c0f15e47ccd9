// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "output/tables.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace morula::study {
namespace {

/// Means and worst values of one level over the deformed samples of one cell, or of several.
struct Summary {
  double error_sum = 0, error_worst = 0, count = 0;
  double bare_worst = 0, gap_worst = 0, protrusion_worst = 0;
  bool known = true;
  std::vector<std::optional<double>> metric_sums{};

  void add(const MotionRun& cell, std::size_t level, ErrorUnit unit) {
    for (const Sample& s : cell.samples) {
      const LevelFigures* l = cell.at(s.sample, level);
      if (l == nullptr) continue;
      bare_worst = std::max(bare_worst, l->uncovered_area());
      gap_worst = std::max(gap_worst, l->uncovered_distance());
      protrusion_worst = std::max(protrusion_worst, l->protrusion_worst().value_or(0));
      if (s.sample == 0) continue;
      known = known && l->error(unit).has_value();
      metric_sums.resize(l->metrics.size(), 0.0);
      for (std::size_t i = 0; i < metric_sums.size(); ++i) {
        if (l->metrics[i] && metric_sums[i])
          *metric_sums[i] += *l->metrics[i];
        else
          metric_sums[i].reset();
      }
      error_sum += l->error(unit).value_or(0);
      error_worst = std::max(error_worst, l->error(unit).value_or(0));
      count += 1;
    }
  }
  std::optional<double> mean() const { return known && count > 0 ? std::optional(error_sum / count) : std::nullopt; }
  std::optional<double> metric_mean(std::size_t i) const {
    return i < metric_sums.size() && metric_sums[i] ? std::optional(*metric_sums[i] / count) : std::nullopt;
  }
};

Table tree_table(const Plan& plan, const Result& result) {
  Table table{"trees",
              "Trees at rest, and void spheres",
              "A void sphere encloses no vertex. Grown: radii of trees from files that had to grow for their level "
              "to cover. The prism has many sides and no division along: long thin triangles.",
              false,
              {"body", "method", "level", "nodes", "void spheres", "void, %", "grown"},
              {}};
  for (const std::vector<TreeFigures>* list : {&result.trees, &result.needles}) {
    for (const TreeFigures& tree : *list) {
      for (std::size_t level = 0; level < tree.levels.size(); ++level) {
        const TreeLevel& l = tree.levels[level];
        const double share =
            l.nodes > 0 ? 100.0 * static_cast<double>(l.void_spheres) / static_cast<double>(l.nodes) : 0;
        table.rows.push_back({list == &result.needles ? std::string("prism") : plan.body_of(tree.source).name,
                              plan.sources[tree.source].method, level, l.nodes, l.void_spheres, share, l.grown});
      }
    }
  }
  return table;
}

Table rule_table(const Plan& plan, const Result& result) {
  Table table{
      "rules",
      "Every tree, motion and rule",
      fmt::format("Mean and worst {} ({}) over the deformed samples; uncovered area in % of the surface, gap and "
                  "protrusion in % of the diagonal at rest, the worst of all samples. fresh: a tree built "
                  "anew, at samples of its own.",
                  error_label(plan.unit), error_unit(plan.unit)),
      false,
      {"body", "method", "motion", "level", "rule", "at rest", "mean", "worst", "bare, %", "gap, %", "protrusion, %"},
      {}};
  for (const OwnMetric& metric : plan.metrics) table.columns.push_back(metric.name + ", mean");
  for (const MotionRun& cell : result.cells) {
    for (const std::size_t level : plan.levels()) {
      Summary s;
      s.add(cell, level, plan.unit);
      const LevelFigures* rest = cell.at(0, level);
      table.rows.push_back({plan.body_of(cell.key.source).name, plan.sources[cell.key.source].method,
                            describe_all(plan.motions[cell.key.motion]), level, plan.rules[cell.key.rule].name,
                            rest == nullptr ? TableValue() : value_of(rest->error(plan.unit)), value_of(s.mean()),
                            s.mean() ? TableValue(s.error_worst) : TableValue(), 100 * s.bare_worst, 100 * s.gap_worst,
                            100 * s.protrusion_worst});
      for (std::size_t i = 0; i < plan.metrics.size(); ++i) table.rows.back().push_back(value_of(s.metric_mean(i)));
    }
  }
  return table;
}

Table floor_table(const Plan& plan, const Result& result) {
  Table table{"floor",
              "Error at the full amount, beside a tree built anew there",
              fmt::format("{} ({}); ratios to the fresh tree of the same generator.", error_label(plan.unit),
                          error_unit(plan.unit)),
              false,
              {"body", "method", "motion", "level", "fresh", "exact", "over fresh", "rebuilt", "over fresh"},
              {}};
  const std::size_t last = plan.samples - 1;
  for (const MotionRun& cell : result.cells) {
    if (plan.rules[cell.key.rule].kind != study::fresh) continue;
    for (const std::size_t level : plan.levels()) {
      const auto error_of = [&](const RuleKey& rule) -> std::optional<double> {
        const std::optional<std::size_t> place = plan.find_rule(rule);
        const MotionRun* other = place ? result.find({cell.key.source, cell.key.motion, *place}) : nullptr;
        const LevelFigures* l = other == nullptr ? nullptr : other->at(last, level);
        return l == nullptr ? std::nullopt : l->error(plan.unit);
      };
      const std::optional<double> fresh = error_of(study::fresh);
      const std::optional<double> exact = error_of(Rule::exact);
      const std::optional<double> rebuilt = error_of(study::rebuilt);
      const auto over = [&](const std::optional<double>& value) {
        return value && fresh && *fresh > 0 ? TableValue(*value / *fresh) : TableValue();
      };
      table.rows.push_back({plan.body_of(cell.key.source).name, plan.sources[cell.key.source].method,
                            describe_all(plan.motions[cell.key.motion]), level, value_of(fresh), value_of(exact),
                            over(exact), value_of(rebuilt), over(rebuilt)});
    }
  }
  return table;
}

/// Mean error over both levels and all motions; the worst uncovered area.
struct Mix {
  std::string name;
  std::optional<double> error;
  double bare = 0;
  std::optional<double> points, nanoseconds;
};

std::vector<Mix> ranked_mixes(const Plan& plan, const Result& result, const Cost& cost) {
  std::vector<Mix> mixes;
  for (std::size_t r = 0; r < plan.mixes.size(); ++r) {
    Summary s;
    for (const MotionRun& cell : result.mixes)
      if (cell.key.rule == r)
        for (const std::size_t level : plan.levels()) s.add(cell, level, plan.unit);
    mixes.push_back({plan.mixes[r].name, s.mean(), s.bare_worst, {}, {}});
    if (const UpdateCost* time = cost.find(plan.mixes[r].name)) {
      mixes.back().points = time->points_per_vertex;
      mixes.back().nanoseconds = time->nanoseconds_per_vertex;
    }
  }
  return mixes;
}

void add_mix_tables(const Plan& plan, const Result& result, const Cost& cost, std::vector<Table>& tables) {
  std::vector<Mix> mixes = ranked_mixes(plan, result, cost);
  const std::string of =
      fmt::format("{} tree of {}, mean over all motions, levels {}-{} and deformed samples",
                  plan.sources.front().method, plan.bodies.front().name, plan.levels().front(), plan.levels().back());
  std::stable_sort(mixes.begin(), mixes.end(), [](const Mix& a, const Mix& b) {
    if ((a.bare == 0) != (b.bare == 0)) return a.bare == 0;
    return a.error.value_or(0) < b.error.value_or(0);
  });
  Table by_error{"mixes",
                 "Mixes of rules by looseness: those that leave nothing bare first",
                 "Inner levels + leaves; covering: radii grow to what owned corners need. " + of + ".",
                 false,
                 {"mix", error_label(plan.unit), "worst uncovered area, %", "points per vertex"},
                 {}};
  for (const Mix& mix : mixes)
    by_error.rows.push_back({mix.name, value_of(mix.error), 100 * mix.bare, value_of(mix.points)});
  tables.push_back(std::move(by_error));
  std::erase_if(mixes, [](const Mix& mix) { return mix.bare > 0; });
  std::stable_sort(mixes.begin(), mixes.end(), [](const Mix& a, const Mix& b) {
    return a.nanoseconds && b.nanoseconds && *a.nanoseconds < *b.nanoseconds;
  });
  Table by_cost{"mixes-cost",
                "Mixes that leave nothing bare, by cost",
                "Nanoseconds per vertex of an update of all levels, one thread, median: differs from run to run.",
                true,
                {"mix", "ns per vertex", error_label(plan.unit)},
                {}};
  for (const Mix& mix : mixes) by_cost.rows.push_back({mix.name, value_of(mix.nanoseconds), value_of(mix.error)});
  tables.push_back(std::move(by_cost));
}

Table cost_table(const Plan& plan, const Cost& cost) {
  Table table{"cost",
              "Cost of an update of all levels",
              fmt::format("{}, {} tree, {} vertices; one thread, median: differs from run to run.",
                          plan.bodies.front().name, plan.sources[cost.source].method, cost.vertices),
              true,
              {"what", "ns per vertex", "over boxes", "points per vertex"},
              {}};
  const UpdateCost* boxes = cost.find("boxes");
  for (const std::vector<UpdateCost>* list : {&cost.boxes, &cost.rules}) {
    for (const UpdateCost& c : *list) {
      const double over =
          boxes->nanoseconds_per_vertex > 0 ? c.nanoseconds_per_vertex / boxes->nanoseconds_per_vertex : 0;
      table.rows.push_back({c.name, c.nanoseconds_per_vertex, over, c.points_per_vertex});
    }
  }
  return table;
}

Table body_table(const Plan& plan, const std::vector<std::vector<Claim>>& of_bodies) {
  Table table{"bodies", "Verdicts body by body", "", false, {"body"}, {}};
  for (const Claim& claim : of_bodies.front())
    if (!claim.timed) table.columns.push_back(claim.id);
  for (std::size_t body = 0; body < of_bodies.size(); ++body) {
    std::vector<TableValue> row{plan.bodies[body].name};
    for (const Claim& claim : of_bodies[body])
      if (!claim.timed) row.emplace_back(std::string(name(claim.verdict)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<Table> make_tables(const Plan& plan, const Result& result, const Cost& cost,
                               const std::vector<std::vector<Claim>>& of_bodies) {
  std::vector<Table> tables;
  if (of_bodies.size() > 1) tables.push_back(body_table(plan, of_bodies));
  tables.push_back(rule_table(plan, result));
  if (Table floor = floor_table(plan, result); !floor.rows.empty()) tables.push_back(std::move(floor));
  tables.push_back(tree_table(plan, result));
  if (!result.presses.empty()) tables.push_back(make_press_table(plan, result));
  if (!plan.mixes.empty()) add_mix_tables(plan, result, cost, tables);
  tables.push_back(cost_table(plan, cost));
  return tables;
}

}  // namespace morula::study
