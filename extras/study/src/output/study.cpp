// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <morula/io/whole_output.hpp>
#include <morula/study/amounts.hpp>
#include <morula/study/study.hpp>
#include <morula/study/variants.hpp>

#include "output/pictures.hpp"

namespace morula::study {

using namespace toolbox;

Study make_study(Plan plan, Workers& workers, const RunOptions& options) {
  const auto tell = [&](const char* what) {
    if (options.progress) options.progress(1, what);
  };
  Study study;
  study.plan = std::move(plan);
  study.result = run(study.plan, workers, options);
  tell("timing updates");
  study.cost = measure_cost(study.plan, study.result, options.cache);
  std::vector<std::vector<Claim>> of_bodies;
  for (std::size_t body = 0; body < study.plan.bodies.size(); ++body)
    of_bodies.push_back(make_claims(study.plan, study.result, body, body == 0 ? &study.cost : nullptr));
  study.claims = join_claims(of_bodies);
  study.figures = make_figures(study.plan, study.result);
  for (Figure& figure : make_press_figures(study.plan, study.result)) study.figures.push_back(std::move(figure));
  study.tables = make_tables(study.plan, study.result, study.cost, of_bodies);
  if (study.plan.variants) {
    tell("variants");
    study.tables.push_back(variants_table(study.plan, run_variants(study.plan, workers, options)));
  }
  if (study.plan.paper_amounts) {
    tell("the paper's amounts");
    PaperAmounts amounts = find_paper_amounts(study.plan, workers, options);
    study.tables.push_back(amounts_table(study.plan, amounts));
    for (Figure& figure : amounts.figures) study.figures.push_back(std::move(figure));
  }
  tell("drawing");
  study.pictures = make_pictures(study.plan, study.result);
  return study;
}

std::vector<std::span<const Figure>> groups_of(std::span<const Figure> figures) {
  std::vector<std::span<const Figure>> groups;
  for (std::size_t begin = 0; begin < figures.size();) {
    std::size_t end = begin + 1;
    while (end < figures.size() && figures[end].group == figures[begin].group) ++end;
    groups.push_back(figures.subspan(begin, end - begin));
    begin = end;
  }
  return groups;
}

std::string figure_svg(std::span<const Figure> group) {
  return svg_plot(plot_of(group));
}

void write_study(const Study& study, const std::filesystem::path& folder) {
  for (const std::span<const Figure> group : groups_of(study.figures)) {
    write_whole(folder / (group.front().group + ".csv"), figure_csv(group));
    write_whole(folder / (group.front().group + ".svg"), figure_svg(group));
  }
  for (const Table& table : study.tables) write_whole(folder / (table.id + ".csv"), table_csv(table));
  for (const Picture& picture : study.pictures) write_whole(folder / (picture.id + ".svg"), picture.svg);
  write_whole(folder / "cells.csv", cells_csv(study.plan, study.result));
  write_whole(folder / "study.json", study_json(study));
}

std::vector<std::string> faults(const Plan& plan, const Result& result) {
  std::vector<std::string> list;
  for (const MotionRun& cell : result.cells) {
    const FollowRule& rule = plan.rules[cell.key.rule];
    if (rule.own) continue;  // promises nothing
    const std::string where =
        fmt::format("{}, {} tree, {}", plan.body_of(cell.key.source).name, plan.sources[cell.key.source].method,
                    describe_all(plan.motions[cell.key.motion]));
    if (cell.returns_to_rest && !*cell.returns_to_rest)
      list.push_back(fmt::format("{} does not return to rest ({})", rule.name, where));
    if (rule.key() != RuleKey(Rule::exact) && rule.kind == RuleKey::Kind::update) continue;
    const bool certified = !cell.certificate || cell.certificate->covered;
    if (cell.worst_uncovered_area() > 0 || cell.worst_uncovered_distance() > 0 || !certified)
      list.push_back(fmt::format("{} leaves surface bare ({})", rule.name, where));
  }
  for (const PressCell& cell : result.presses) {
    const Source& source = plan.pressed(cell.source);
    const bool lost =
        std::any_of(cell.figures.begin(), cell.figures.end(), [](const PressFigures& f) { return f.lost > 0; });
    if (lost && plan.press_rules[cell.rule].key() == RuleKey(Rule::exact))
      list.push_back(
          fmt::format("exact loses a crossing ({}, {} tree, pressed)", plan.bodies[source.body].name, source.method));
  }
  return list;
}

std::string claims_text(std::span<const Claim> claims, bool quick) {
  std::string text;
  if (quick)
    text +=
        "A quick study decides what is marked \"always\". Its other verdicts, in brackets, are about a small body "
        "with few samples; those of a full study may be the opposite.\n\n";
  for (const ClaimOrigin origin : {ClaimOrigin::paper, ClaimOrigin::ours}) {
    text += origin == ClaimOrigin::paper ? "What the paper claims, and whether it holds here\n"
                                         : "\nWhat it did not measure\n";
    for (const Claim& claim : claims) {
      if (claim.origin != origin) continue;
      const bool decided = !quick || claim.guarantee || claim.verdict == Verdict::untested;
      const std::string verdict = decided ? std::string(word(claim)) : fmt::format("({})", word(claim));
      text += fmt::format("  {:<9} {}{}\n", verdict, claim.claim, quick && claim.guarantee ? " (always)" : "");
      if (!claim.numbers.empty()) text += fmt::format("            {}\n", claim.numbers);
    }
  }
  return text;
}

std::string contents_text(const Study& study) {
  std::string text = "- study.json: everything; cells.csv: every measurement with all digits\n";
  text += fmt::format("- {} figures as .svg and .csv: fig1, fig2a, fig2b, fig2c-*, fig2d-*, rules-*, press-*{}\n",
                      groups_of(study.figures).size() + study.pictures.size(),
                      study.plan.paper_amounts ? ", paper-axes-*" : "");
  text += "- tables as .csv:";
  for (const Table& table : study.tables) text += ' ' + table.id;
  return text + '\n';
}

}  // namespace morula::study
