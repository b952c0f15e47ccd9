// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <morula/io/whole_output.hpp>
#include <morula/study/amounts.hpp>
#include <morula/study/study.hpp>
#include <morula/study/variants.hpp>
#include <toolbox/numbers.hpp>

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
  std::vector<std::vector<Claim>> of_trials;
  for (const Trial& trial : study.plan.trials())
    of_trials.push_back(make_claims(study.plan, study.result, trial, trial.body == 0 ? &study.cost : nullptr));
  study.claims = join_claims(of_trials);
  study.stability = stability_of(study.plan, of_trials);
  study.figures = make_figures(study.plan, study.result);
  for (Figure& figure : make_press_figures(study.plan, study.result)) study.figures.push_back(std::move(figure));
  study.tables = make_tables(study.plan, study.result, study.cost, of_trials);
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

std::string figure_pdf(std::span<const Figure> group) {
  return pdf_plot(plot_of(group));
}

std::string figure_pgf(std::span<const Figure> group) {
  return pgf_plot(plot_of(group));
}

std::string_view name(FigureFormat format) {
  constexpr std::array<std::string_view, 4> names{"svg", "csv", "pdf", "pgf"};
  return names[static_cast<std::size_t>(format)];
}

std::span<const FigureFormat> all_figure_formats() {
  static constexpr std::array all{FigureFormat::svg, FigureFormat::csv, FigureFormat::pdf, FigureFormat::pgf};
  return all;
}

std::vector<FigureFormat> default_figure_formats() {
  return {FigureFormat::svg, FigureFormat::csv};
}

void write_study(const Study& study, const std::filesystem::path& folder, const std::vector<FigureFormat>& formats) {
  const auto file_of = [&](const std::string& id, FigureFormat format) {
    return folder / fmt::format("{}.{}", id, name(format));
  };
  for (const FigureFormat format : formats) {
    const auto write_figure = format == FigureFormat::svg   ? figure_svg
                              : format == FigureFormat::csv ? figure_csv
                              : format == FigureFormat::pdf ? figure_pdf
                                                            : figure_pgf;
    for (const std::span<const Figure> group : groups_of(study.figures))
      write_whole(file_of(group.front().group, format), write_figure(group));
    for (const Picture& picture : study.pictures) {
      if (format == FigureFormat::svg) write_whole(file_of(picture.id, format), picture.svg);
      if (format == FigureFormat::pdf) write_whole(file_of(picture.id, format), picture.pdf);
    }
  }
  for (const Table& table : study.tables) write_whole(folder / (table.id + ".csv"), table_csv(table));
  write_whole(folder / "cells.csv", cells_csv(study.plan, study.result));
  write_whole(folder / "study.json", study_json(study));
}

namespace {

/// " of seed 2".
std::string seed_text(const Source& source) {
  return source.seed ? fmt::format(" of seed {}", *source.seed) : std::string();
}

/// Dependence of the verdict, in shares of pairs of trials; empty if it depends on nothing.
std::string depends_text(const Claim& claim) {
  std::string text;
  const auto add = [&](const char* what, const std::optional<double>& share) {
    if (share && *share > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", what, percent(*share));
  };
  add("seed", claim.dependence.seed);
  add("body", claim.dependence.body);
  add("half the amount", claim.dependence.amount);
  add("half the resolution", claim.dependence.resolution);
  return text.empty() ? text : fmt::format("The verdict changes with: {} of pairs.", text);
}

}  // namespace

std::vector<std::string> faults(const Plan& plan, const Result& result) {
  std::vector<std::string> list;
  for (const MotionRun& cell : result.cells) {
    const FollowRule& rule = plan.rules[cell.key.rule];
    if (rule.own) continue;  // promises nothing
    const std::string where =
        fmt::format("{}, {} tree{}, {}", plan.body_of(cell.key.source).name, plan.sources[cell.key.source].method,
                    seed_text(plan.sources[cell.key.source]), plan.motion_name(cell.key.motion));
    if (cell.returns_to_rest && !*cell.returns_to_rest)
      list.push_back(fmt::format("{} does not return to rest ({})", rule.name, where));
    if (rule.key() != RuleKey(Rule::exact) && rule.kind == RuleKey::Kind::update) continue;
    const bool certified = !cell.certificate || cell.certificate->covered;
    if (cell.worst_uncovered_area() > 0 || cell.worst_uncovered_distance() > 0 || !certified)
      list.push_back(fmt::format("{} leaves surface uncovered ({})", rule.name, where));
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

std::string claims_text(std::span<const Claim> claims) {
  std::string text;
  for (const ClaimOrigin origin : {ClaimOrigin::paper, ClaimOrigin::ours}) {
    text += origin == ClaimOrigin::paper ? "Claims of the paper\n" : "\nFurther claims\n";
    for (const Claim& claim : claims) {
      if (claim.origin != origin) continue;
      text += fmt::format("  {:<11} {}\n", word(claim), claim.claim);
      if (!claim.place.empty()) text += fmt::format("              In the paper: {}.\n", claim.place);
      if (!claim.numbers.empty()) text += fmt::format("              {}\n", claim.numbers);
      if (const std::string depends = depends_text(claim); !depends.empty())
        text += fmt::format("              {}\n", depends);
      if (!claim.times.empty()) text += fmt::format("              {}\n", claim.times);
    }
  }
  return text;
}

std::string trials_text(const Study& study) {
  const Plan& plan = study.plan;
  std::string bodies;
  for (const NamedMesh& body : plan.bodies)
    bodies += fmt::format("{}{} ({})", bodies.empty() ? "" : ", ", body.name,
                          counted(body.mesh.vertex_count(), "vertex", "vertices"));
  std::string text = fmt::format(
      "{}: {}; {}. A claim holds if it holds in at least nine tenths of the trials, fails if it fails in as many, and "
      "holds partly otherwise.\n",
      counted(plan.trials().size(), "trial"), bodies, counted(plan.seeds.size(), "seed"));
  if (study.stability)
    text += fmt::format("With half of the seeds each, {} of {} claims have the same verdict.\n", study.stability->same,
                        study.stability->compared);
  return text;
}

std::string contents_text(const Study& study, const std::vector<FigureFormat>& formats) {
  std::string extensions;
  for (std::size_t i = 0; i < formats.size(); ++i)
    extensions += fmt::format("{}.{}", i == 0 ? "" : i + 1 == formats.size() ? " and " : ", ", name(formats[i]));
  std::string text = "- study.json: everything; cells.csv: every measurement with all digits\n";
  text += fmt::format("- {} figures as {}: fig1, fig2a, fig2b, fig2c-*, fig2d-*, rules-*, press-*{}\n",
                      groups_of(study.figures).size() + study.pictures.size(), extensions,
                      study.plan.paper_amounts ? ", paper-axes-*" : "");
  text += "- tables as .csv:";
  for (const Table& table : study.tables) text += ' ' + table.id;
  return text + '\n';
}

}  // namespace morula::study
