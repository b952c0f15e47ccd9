// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "study/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/io/whole_output.hpp>
#include <morula/version.hpp>

#include "shared/figures.hpp"
#include "shared/files.hpp"
#include "shared/table.hpp"
#include "study/pictures.hpp"

namespace morula::cli {
namespace {

Json bodies_json(const StudyPlan& plan) {
  Json bodies = Json::array();
  for (const NamedMesh& body : plan.bodies) {
    const MeshReport report = inspect(body.mesh);
    bodies.push_back({{"name", body.name},
                      {"vertices", body.mesh.vertex_count()},
                      {"facets", body.mesh.facet_count()},
                      {"volume", report.has_volume() ? Json(report.volume) : Json(nullptr)}});
  }
  return bodies;
}

Json study_json(const Study& study) {
  Json json{{"morula", version},
            {"title", "Sphere trees on deforming bodies: the evaluation of Garcia, Bayona, Toharia and Mendoza, again"},
            {"settings", settings_json(study.plan)},
            {"bodies", bodies_json(study.plan)}};
  Json claims = Json::array();
  for (const StudyClaim& claim : study.claims) claims.push_back(claim_json(claim));
  Json figures = Json::array();
  for (const StudyFigure& figure : study.figures) figures.push_back(figure_json(figure));
  Json tables = Json::array();
  for (const StudyTable& table : study.tables) tables.push_back(table_json(table));
  Json pictures = Json::array();
  for (const StudyPicture& p : study.pictures) pictures.push_back({{"id", p.id}, {"title", p.title}, {"svg", p.svg}});
  Json cells = Json::array();
  for (const std::vector<StudyCell>* list : {&study.result.cells, &study.result.mixes})
    for (const StudyCell& cell : *list) cells.push_back(cell_json(cell));
  json["claims"] = claims;
  json["figures"] = figures;
  json["tables"] = tables;
  json["pictures"] = pictures;
  json["skipped"] = study.result.skipped;
  Json presses = Json::array();
  for (const PressCell& press : study.result.presses) presses.push_back(press_json(press));
  json["cells"] = cells;
  json["presses"] = presses;
  json["press_truths"] = study.result.truths;
  json["cost"] = cost_json(study.cost);
  return json;
}

/// A figure and its companions, sample by sample: one row per curve and sample.
std::string figure_csv(const std::vector<const StudyFigure*>& group) {
  const std::vector<std::string>& names = group.front()->x_names;
  std::string text = fmt::format("figure,series,role,{},y\n", names.empty() ? "sample" : "query");
  for (const StudyFigure* figure : group) {
    for (const StudySeries& s : figure->series) {
      for (std::size_t i = 0; i < s.x.size(); ++i) {
        text += fmt::format("{},{},{},{},{}\n", figure->id, csv_cell(s.name), name(s.role),
                            names.empty() ? exact_digits(s.x[i]) : csv_cell(names[static_cast<std::size_t>(s.x[i])]),
                            s.y[i] ? exact_digits(*s.y[i]) : std::string());
      }
    }
  }
  return text;
}

std::string cell_text(const Json& value, bool all_digits) {
  if (value.is_null()) return all_digits ? "" : "n/a";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return all_digits ? exact_digits(value.get<double>()) : figure(value.get<double>());
  return json_text(value, -1);
}

std::string table_csv(const StudyTable& table) {
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) text += (i == 0 ? "" : ",") + csv_cell(table.columns[i]);
  text += '\n';
  for (const std::vector<Json>& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) text += (i == 0 ? "" : ",") + csv_cell(cell_text(row[i], true));
    text += '\n';
  }
  return text;
}

/// Every measurement.
std::string cells_csv(const StudyResult& result) {
  std::string text =
      "body,method,motion,rule,sample,parameter,level,spheres,looseness,looseness_box,looseness_fixed,missed_volume,"
      "bare_area,gap,protrusion_worst,protrusion_mean,returns_to_rest\n";
  const auto digits = [](const std::optional<double>& value) { return value ? exact_digits(*value) : std::string(); };
  for (const std::vector<StudyCell>* list : {&result.cells, &result.mixes}) {
    for (const StudyCell& c : *list) {
      for (const StudySample& s : c.samples) {
        for (const StudyLevel& l : s.levels) {
          text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_cell(c.body),
                              csv_cell(c.method), csv_cell(c.motion), csv_cell(c.rule), s.sample,
                              exact_digits(s.parameter), l.level, l.spheres, digits(l.looseness),
                              digits(l.looseness_box), digits(l.looseness_fixed), digits(l.missed_volume),
                              exact_digits(l.bare_area), exact_digits(l.gap), digits(l.protrusion_worst),
                              digits(l.protrusion_mean), c.returns_to_rest ? (*c.returns_to_rest ? "yes" : "no") : "");
        }
      }
    }
  }
  return text;
}

std::vector<std::vector<const StudyFigure*>> groups_of(const std::vector<StudyFigure>& figures) {
  std::vector<std::vector<const StudyFigure*>> groups;
  for (const StudyFigure& figure : figures) {
    if (groups.empty() || groups.back().front()->group != figure.group) groups.emplace_back();
    groups.back().push_back(&figure);
  }
  return groups;
}

}  // namespace

Study make_study(const StudyPlan& plan, const StudyCache& cache, Workers& workers, const std::stop_token& stop,
                 const std::function<void(double, std::string)>& progress) {
  Study study;
  study.plan = plan;
  study.result = run_study(plan, cache, workers, stop, progress);
  progress(1, "timing updates");
  study.cost = measure_cost(plan, study.result, cache);
  std::vector<std::vector<StudyClaim>> of_bodies;
  for (const NamedMesh& body : plan.bodies)
    of_bodies.push_back(make_claims(plan, study.result, body.name, of_bodies.empty() ? &study.cost : nullptr));
  study.claims = join_claims(of_bodies);
  study.figures = make_figures(plan, study.result);
  for (StudyFigure& figure : make_press_figures(plan, study.result)) study.figures.push_back(std::move(figure));
  study.tables = make_tables(plan, study.result, study.cost, of_bodies);
  progress(1, "drawing");
  study.pictures = make_pictures(plan, study.result);
  study.json = study_json(study);
  return study;
}

void write_study(const Study& study, const std::filesystem::path& folder) {
  for (const std::vector<const StudyFigure*>& group : groups_of(study.figures)) {
    write_whole(folder / (group.front()->group + ".csv"), figure_csv(group));
    write_whole(folder / (group.front()->group + ".svg"), svg_plot(plot_of(group)));
  }
  for (const StudyTable& table : study.tables) write_whole(folder / (table.id + ".csv"), table_csv(table));
  for (const StudyPicture& picture : study.pictures) write_whole(folder / (picture.id + ".svg"), picture.svg);
  write_whole(folder / "cells.csv", cells_csv(study.result));
  write_whole(folder / "study.json", json_text(study.json, 1) + "\n");
}

std::vector<std::string> study_faults(const StudyResult& result) {
  std::vector<std::string> faults;
  for (const StudyCell& cell : result.cells) {
    const std::string where = fmt::format("{}, {} tree, {}", cell.body, cell.method, cell.motion);
    if (cell.returns_to_rest && !*cell.returns_to_rest)
      faults.push_back(fmt::format("{} does not return to rest ({})", cell.rule, where));
    if (cell.rule != "exact" && cell.rule != "refitted" && cell.rule != "fresh") continue;
    bool bare = false;
    for (const StudySample& s : cell.samples)
      for (const StudyLevel& l : s.levels) bare = bare || l.bare_area > 0 || l.gap > 0;
    if (bare) faults.push_back(fmt::format("{} leaves surface bare ({})", cell.rule, where));
  }
  for (const PressCell& cell : result.presses) {
    const bool lost =
        std::any_of(cell.figures.begin(), cell.figures.end(), [](const PressFigures& f) { return f.lost > 0; });
    if (lost && cell.rule == "exact")
      faults.push_back(fmt::format("exact loses a crossing ({}, {} tree, pressed)", cell.body, cell.method));
  }
  return faults;
}

std::string claims_text(const std::vector<StudyClaim>& claims) {
  std::string text;
  for (const char* source : {"paper", "new"}) {
    text += fmt::format("{}\n", source == std::string("paper") ? "What the paper claims, and whether it holds here"
                                                               : "\nWhat it did not measure");
    for (const StudyClaim& claim : claims) {
      if (claim.source != source) continue;
      text += fmt::format("  {:<9} {}\n", claim.verdict, claim.claim);
      if (!claim.numbers.empty()) text += fmt::format("            {}\n", claim.numbers);
    }
  }
  return text;
}

std::string contents_text(const Study& study) {
  std::string text = "- study.json: everything; cells.csv: every measurement with all digits\n";
  text += fmt::format("- {} figures as .svg and .csv: fig1, fig2a, fig2b, fig2c-*, fig2d-*, rules-*, press-*\n",
                      groups_of(study.figures).size() + study.pictures.size());
  text += "- tables as .csv:";
  for (const StudyTable& table : study.tables) text += ' ' + table.id;
  return text + '\n';
}

}  // namespace morula::cli
