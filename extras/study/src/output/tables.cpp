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
  double uncovered_worst = 0, distance_worst = 0, protrusion_worst = 0;
  bool known = true;
  std::vector<std::optional<double>> metric_sums{};

  void add(const Plan& plan, const MotionRun& cell, std::size_t level) {
    const ErrorUnit unit = plan.unit;
    const std::vector<std::size_t> decisive = plan.decisive_samples();
    for (const Sample& s : cell.samples) {
      if (std::find(decisive.begin(), decisive.end(), s.sample) == decisive.end()) continue;
      const LevelFigures* l = cell.at(s.sample, level);
      if (l == nullptr) continue;
      uncovered_worst = std::max(uncovered_worst, l->uncovered_area());
      distance_worst = std::max(distance_worst, l->uncovered_distance());
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
              {"body", "method", "seed", "level", "nodes", "void spheres", "void, %", "grown"},
              {}};
  for (const std::vector<TreeFigures>* list : {&result.trees, &result.needles}) {
    for (const TreeFigures& tree : *list) {
      for (std::size_t level = 0; level < tree.levels.size(); ++level) {
        const TreeLevel& l = tree.levels[level];
        const double share =
            l.nodes > 0 ? 100.0 * static_cast<double>(l.void_spheres) / static_cast<double>(l.nodes) : 0;
        table.rows.push_back({list == &result.needles ? std::string("prism") : plan.body_of(tree.source).name,
                              plan.sources[tree.source].method, seed_value(plan.sources[tree.source]), level, l.nodes,
                              l.void_spheres, share, l.grown});
      }
    }
  }
  return table;
}

Table rule_table(const Plan& plan, const Result& result) {
  Table table{
      "rules",
      "Every tree, motion and rule",
      fmt::format("Mean and worst {} ({}) over the deformed samples that decide claims; uncovered area in % of the "
                  "surface, uncovered distance and protrusion in % of the diagonal at rest, the worst of these "
                  "samples. fresh: a new tree for the deformed mesh, at samples of its own.",
                  error_label(plan.unit), error_unit(plan.unit)),
      false,
      {"body", "method", "seed", "motion", "level", "rule", "at rest", "mean", "worst", "uncovered, %",
       "uncovered distance, %", "protrusion, %"},
      {}};
  for (const OwnMetric& metric : plan.metrics) table.columns.push_back(metric.name + ", mean");
  for (const MotionRun& cell : result.cells) {
    for (const std::size_t level : plan.levels()) {
      Summary s;
      s.add(plan, cell, level);
      const LevelFigures* rest = cell.at(0, level);
      table.rows.push_back({plan.body_of(cell.key.source).name, plan.sources[cell.key.source].method,
                            seed_value(plan.sources[cell.key.source]), plan.motion_name(cell.key.motion), level,
                            plan.rules[cell.key.rule].name,
                            rest == nullptr ? TableValue() : value_of(rest->error(plan.unit)), value_of(s.mean()),
                            s.mean() ? TableValue(s.error_worst) : TableValue(), 100 * s.uncovered_worst,
                            100 * s.distance_worst, 100 * s.protrusion_worst});
      for (std::size_t i = 0; i < plan.metrics.size(); ++i) table.rows.back().push_back(value_of(s.metric_mean(i)));
    }
  }
  return table;
}

Table floor_table(const Plan& plan, const Result& result) {
  Table table{"floor",
              "Error at the full amount, next to that of a new tree there",
              fmt::format("{} ({}); ratios to the fresh tree of the same generator.", error_label(plan.unit),
                          error_unit(plan.unit)),
              false,
              {"body", "method", "seed", "motion", "level", "fresh", "exact", "over fresh", "rebuilt", "over fresh"},
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
                            seed_value(plan.sources[cell.key.source]), plan.motion_name(cell.key.motion), level,
                            value_of(fresh), value_of(exact), over(exact), value_of(rebuilt), over(rebuilt)});
    }
  }
  return table;
}

/// Mean error over both levels and all motions; the worst uncovered area.
struct Mix {
  std::string name;
  std::optional<double> error;
  double uncovered = 0;
  std::optional<double> points, nanoseconds;
};

std::vector<Mix> ranked_mixes(const Plan& plan, const Result& result, const Cost& cost) {
  std::vector<Mix> mixes;
  for (std::size_t r = 0; r < plan.mixes.size(); ++r) {
    Summary s;
    for (const MotionRun& cell : result.mixes)
      if (cell.key.rule == r)
        for (const std::size_t level : plan.levels()) s.add(plan, cell, level);
    mixes.push_back({plan.mixes[r].name, s.mean(), s.uncovered_worst, {}, {}});
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
    if ((a.uncovered == 0) != (b.uncovered == 0)) return a.uncovered == 0;
    return a.error.value_or(0) < b.error.value_or(0);
  });
  Table by_error{"mixes",
                 "Mixes of rules by looseness: those that leave no surface uncovered first",
                 "Inner levels + leaves; covering: radii grow to contain owned corners. " + of + ".",
                 false,
                 {"mix", error_label(plan.unit), "worst uncovered area, %", "points per vertex"},
                 {}};
  for (const Mix& mix : mixes)
    by_error.rows.push_back({mix.name, value_of(mix.error), 100 * mix.uncovered, value_of(mix.points)});
  tables.push_back(std::move(by_error));
  std::erase_if(mixes, [](const Mix& mix) { return mix.uncovered > 0; });
  std::stable_sort(mixes.begin(), mixes.end(), [](const Mix& a, const Mix& b) {
    return a.nanoseconds && b.nanoseconds && *a.nanoseconds < *b.nanoseconds;
  });
  Table by_cost{"mixes-cost",
                "Mixes that leave no surface uncovered, by cost",
                "Nanoseconds per vertex of an update of all levels, one thread, median: differs from run to run.",
                true,
                {"mix", "ns per vertex", error_label(plan.unit)},
                {}};
  for (const Mix& mix : mixes) by_cost.rows.push_back({mix.name, value_of(mix.nanoseconds), value_of(mix.error)});
  tables.push_back(std::move(by_cost));
}

Table cost_table(const Plan& plan, const Cost& cost) {
  Table table{
      "cost",
      "Times of an update of all levels",
      fmt::format("{}, {} tree, {} vertices; one thread, all rules in turns, median and quartiles: differs from "
                  "run to run.",
                  plan.bodies.front().name, plan.sources[cost.source].method, cost.vertices),
      true,
      {"what", "ns per vertex", "lower quartile", "upper quartile", "over boxes", "points per vertex"},
      {}};
  const UpdateCost* boxes = cost.find("boxes");
  for (const std::vector<UpdateCost>* list : {&cost.boxes, &cost.rules}) {
    for (const UpdateCost& c : *list) {
      const double over =
          boxes->nanoseconds_per_vertex > 0 ? c.nanoseconds_per_vertex / boxes->nanoseconds_per_vertex : 0;
      table.rows.push_back(
          {c.name, c.nanoseconds_per_vertex, c.lower_quartile, c.upper_quartile, over, c.points_per_vertex});
    }
  }
  return table;
}

Table count_table(const Plan& plan, const Result& result) {
  Table table{
      "work",
      "Work of an update of all levels, counted",
      "Per vertex of the mesh. Points: each time that a node reads a vertex or a corner. Children: the same of "
      "spheres and boxes. Distances: to points, children and corners of boxes. The counts of exact are upper bounds.",
      false,
      {"body", "method", "seed", "what", "points", "children", "distances", "bytes read", "bytes written",
       "bytes over boxes"},
      {}};
  for (const TreeFigures& tree : result.trees) {
    const UpdateCounts* boxes = tree.find_counts("boxes");
    const auto vertices = static_cast<double>(plan.body_of(tree.source).mesh.vertex_count());
    const auto each = [&](std::size_t count) { return static_cast<double>(count) / vertices; };
    for (const UpdateCounts& c : tree.counts) {
      table.rows.push_back({plan.body_of(tree.source).name, plan.sources[tree.source].method,
                            seed_value(plan.sources[tree.source]), c.name, each(c.points_read), each(c.children_read),
                            each(c.distances), each(c.bytes_read), each(c.bytes_written),
                            static_cast<double>(c.bytes()) / static_cast<double>(boxes->bytes())});
    }
  }
  return table;
}

Table trial_table(const std::vector<std::vector<Claim>>& of_trials) {
  Table table{"trials", "Verdicts trial by trial", "A trial is a body with the trees of one seed.",
              false,    {"body", "seed"},          {}};
  for (const Claim& claim : of_trials.front()) table.columns.push_back(claim.id);
  for (const std::vector<Claim>& claims : of_trials) {
    const TrialVerdict& first = claims.front().trials.front();
    std::vector<TableValue> row{first.body, static_cast<std::size_t>(first.seed)};
    for (const Claim& claim : claims) row.emplace_back(std::string(name(claim.verdict)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<Table> make_tables(const Plan& plan, const Result& result, const Cost& cost,
                               const std::vector<std::vector<Claim>>& of_trials) {
  std::vector<Table> tables;
  if (of_trials.size() > 1) tables.push_back(trial_table(of_trials));
  tables.push_back(rule_table(plan, result));
  if (Table floor = floor_table(plan, result); !floor.rows.empty()) tables.push_back(std::move(floor));
  tables.push_back(tree_table(plan, result));
  if (!result.presses.empty()) tables.push_back(make_press_table(plan, result));
  if (!plan.mixes.empty()) add_mix_tables(plan, result, cost, tables);
  tables.push_back(count_table(plan, result));
  tables.push_back(cost_table(plan, cost));
  return tables;
}

}  // namespace morula::study
