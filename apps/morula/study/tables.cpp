// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/tables.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace morula::cli {
namespace {

Json number(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

/// Of one level over the deformed samples of one cell, or of several: means, and the worst of each.
struct Summary {
  double error_sum = 0, error_worst = 0, count = 0;
  double bare_worst = 0, gap_worst = 0, protrusion_worst = 0;
  bool known = true;

  void add(const StudyCell& cell, std::size_t level, ErrorUnit unit) {
    for (const StudySample& s : cell.samples) {
      const StudyLevel* l = cell.at(s.sample, level);
      if (l == nullptr) continue;
      bare_worst = std::max(bare_worst, l->bare_area);
      gap_worst = std::max(gap_worst, l->gap);
      protrusion_worst = std::max(protrusion_worst, l->protrusion_worst.value_or(0));
      if (s.sample == 0) continue;
      known = known && l->error(unit).has_value();
      error_sum += l->error(unit).value_or(0);
      error_worst = std::max(error_worst, l->error(unit).value_or(0));
      count += 1;
    }
  }
  std::optional<double> mean() const { return known && count > 0 ? std::optional(error_sum / count) : std::nullopt; }
};

StudyTable tree_table(const StudyResult& result) {
  StudyTable table{
      "trees",
      "Trees at rest, and void spheres",
      "A void sphere encloses no vertex. Grown: radii of trees from files that had to grow for their level "
      "to cover. The prism has many sides and no division along: long thin triangles.",
      false,
      {"body", "method", "level", "nodes", "void spheres", "void, %", "grown"},
      {}};
  for (const std::vector<StudyTree>* list : {&result.trees, &result.needles}) {
    for (const StudyTree& tree : *list) {
      for (std::size_t level = 0; level < tree.levels.size(); ++level) {
        const TreeLevel& l = tree.levels[level];
        const double share =
            l.nodes > 0 ? 100.0 * static_cast<double>(l.void_spheres) / static_cast<double>(l.nodes) : 0;
        table.rows.push_back({tree.body, tree.method, level, l.nodes, l.void_spheres, share, l.grown});
      }
    }
  }
  return table;
}

StudyTable rule_table(const StudyPlan& plan, const StudyResult& result) {
  StudyTable table{
      "rules",
      "Every tree, motion and rule",
      fmt::format("Mean and worst {} ({}) over the deformed samples; bare area in % of the surface, gap and "
                  "protrusion in % of the diagonal at rest, the worst of all samples. fresh: a tree built "
                  "anew, at samples of its own.",
                  error_label(plan.unit), error_unit(plan.unit)),
      false,
      {"body", "method", "motion", "level", "rule", "at rest", "mean", "worst", "bare, %", "gap, %", "protrusion, %"},
      {}};
  for (const StudyCell& cell : result.cells) {
    for (const std::size_t level : plan.levels()) {
      Summary s;
      s.add(cell, level, plan.unit);
      const StudyLevel* rest = cell.at(0, level);
      table.rows.push_back({cell.body, cell.method, cell.motion, level, cell.rule,
                            rest == nullptr ? Json(nullptr) : number(rest->error(plan.unit)), number(s.mean()),
                            s.mean() ? Json(s.error_worst) : Json(nullptr), 100 * s.bare_worst, 100 * s.gap_worst,
                            100 * s.protrusion_worst});
    }
  }
  return table;
}

StudyTable floor_table(const StudyPlan& plan, const StudyResult& result) {
  StudyTable table{"floor",
                   "Error at the full amount, beside a tree built anew there",
                   fmt::format("{} ({}); ratios to the fresh tree of the same generator.", error_label(plan.unit),
                               error_unit(plan.unit)),
                   false,
                   {"body", "method", "motion", "level", "fresh", "exact", "over fresh", "re-fitted", "over fresh"},
                   {}};
  const std::size_t last = plan.samples - 1;
  for (const StudyCell& cell : result.cells) {
    if (cell.rule != "fresh") continue;
    for (const std::size_t level : plan.levels()) {
      const auto error_of = [&](std::string_view rule) -> std::optional<double> {
        const StudyCell* other = result.find(cell.body, cell.method, cell.motion, rule);
        const StudyLevel* l = other == nullptr ? nullptr : other->at(last, level);
        return l == nullptr ? std::nullopt : l->error(plan.unit);
      };
      const std::optional<double> fresh = error_of("fresh");
      const std::optional<double> exact = error_of("exact");
      const std::optional<double> refitted = error_of("refitted");
      const auto over = [&](const std::optional<double>& value) {
        return value && fresh && *fresh > 0 ? Json(*value / *fresh) : Json(nullptr);
      };
      table.rows.push_back({cell.body, cell.method, cell.motion, level, number(fresh), number(exact), over(exact),
                            number(refitted), over(refitted)});
    }
  }
  return table;
}

/// Mean error over both levels and all motions; the worst bare area.
struct Mix {
  std::string name;
  std::optional<double> error;
  double bare = 0;
  Json points, nanoseconds;
};

std::vector<Mix> ranked_mixes(const StudyPlan& plan, const StudyResult& result, const StudyCost& cost) {
  std::vector<Mix> mixes;
  for (const StudyRule& rule : plan.mixes) {
    Summary s;
    for (const StudyCell& cell : result.mixes)
      if (cell.rule == rule.name)
        for (const std::size_t level : plan.levels()) s.add(cell, level, plan.unit);
    const UpdateCost* time = cost.find(rule.name);
    mixes.push_back({rule.name, s.mean(), s.bare_worst, time == nullptr ? Json(nullptr) : Json(time->points_per_vertex),
                     time == nullptr ? Json(nullptr) : Json(time->nanoseconds_per_vertex)});
  }
  return mixes;
}

void add_mix_tables(const StudyPlan& plan, const StudyResult& result, const StudyCost& cost,
                    std::vector<StudyTable>& tables) {
  std::vector<Mix> mixes = ranked_mixes(plan, result, cost);
  const std::string of =
      fmt::format("{} tree of {}, mean over all motions, levels {}-{} and deformed samples",
                  result.trees.front().method, plan.bodies.front().name, plan.levels().front(), plan.levels().back());
  std::stable_sort(mixes.begin(), mixes.end(), [](const Mix& a, const Mix& b) {
    if ((a.bare == 0) != (b.bare == 0)) return a.bare == 0;
    return a.error.value_or(0) < b.error.value_or(0);
  });
  StudyTable by_error{"mixes",
                      "Mixes of rules by looseness: those that leave nothing bare first",
                      "Inner levels + leaves; covering: radii grow to what owned corners need. " + of + ".",
                      false,
                      {"mix", error_label(plan.unit), "worst bare area, %", "points per vertex"},
                      {}};
  for (const Mix& mix : mixes) by_error.rows.push_back({mix.name, number(mix.error), 100 * mix.bare, mix.points});
  tables.push_back(std::move(by_error));
  std::erase_if(mixes, [](const Mix& mix) { return mix.bare > 0; });
  std::stable_sort(mixes.begin(), mixes.end(), [](const Mix& a, const Mix& b) {
    return !a.nanoseconds.is_null() && !b.nanoseconds.is_null() && a.nanoseconds < b.nanoseconds;
  });
  StudyTable by_cost{"mixes-cost",
                     "Mixes that leave nothing bare, by cost",
                     "Nanoseconds per vertex of an update of all levels, one thread, median: differs from run to run.",
                     true,
                     {"mix", "ns per vertex", error_label(plan.unit)},
                     {}};
  for (const Mix& mix : mixes) by_cost.rows.push_back({mix.name, mix.nanoseconds, number(mix.error)});
  tables.push_back(std::move(by_cost));
}

StudyTable cost_table(const StudyCost& cost) {
  StudyTable table{"cost",
                   "Cost of an update of all levels",
                   fmt::format("{}, {} tree, {} vertices; one thread, median: differs from run to run.", cost.body,
                               cost.method, cost.vertices),
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

StudyTable body_table(const StudyPlan& plan, const std::vector<std::vector<StudyClaim>>& of_bodies) {
  StudyTable table{"bodies", "Verdicts body by body", "", false, {"body"}, {}};
  for (const StudyClaim& claim : of_bodies.front())
    if (!claim.timed) table.columns.push_back(claim.id);
  for (std::size_t body = 0; body < of_bodies.size(); ++body) {
    std::vector<Json> row{plan.bodies[body].name};
    for (const StudyClaim& claim : of_bodies[body])
      if (!claim.timed) row.emplace_back(claim.verdict);
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

std::vector<StudyTable> make_tables(const StudyPlan& plan, const StudyResult& result, const StudyCost& cost,
                                    const std::vector<std::vector<StudyClaim>>& of_bodies) {
  std::vector<StudyTable> tables;
  if (of_bodies.size() > 1) tables.push_back(body_table(plan, of_bodies));
  tables.push_back(rule_table(plan, result));
  if (StudyTable floor = floor_table(plan, result); !floor.rows.empty()) tables.push_back(std::move(floor));
  tables.push_back(tree_table(result));
  if (!result.presses.empty()) tables.push_back(make_press_table(plan, result));
  if (!plan.mixes.empty()) add_mix_tables(plan, result, cost, tables);
  tables.push_back(cost_table(cost));
  return tables;
}

}  // namespace morula::cli
