// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// study.json.
#include "json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/study/study.hpp>
#include <morula/version.hpp>

#include "output/styles.hpp"
#include "output/summary.hpp"
#include "run/cost.hpp"
#include "run/press.hpp"

namespace morula::study {
namespace {

template <class Item, class Write>
Json array_of(const std::vector<Item>& items, const Write& write) {
  Json json = Json::array();
  for (const Item& item : items) json.push_back(write(item));
  return json;
}

Json motion_names(const Plan& plan) {
  Json names = Json::array();
  for (std::size_t m = 0; m < plan.motion_count(); ++m) names.push_back(plan.motion_name(m));
  return names;
}

/// The settings that decide the figures: the whole plan without bodies, trees and threads.
Json settings_json(const Plan& plan) {
  const auto rule_name = [](const FollowRule& rule) { return rule.name; };
  return {{"quick", plan.quick},
          {"samples", plan.samples},
          {"parameters", plan.parameters()},
          {"fresh_poses", plan.fresh_poses},
          {"levels", plan.levels()},
          {"branching", plan.branching},
          {"depth", plan.depth},
          {"seeds", plan.seeds},
          {"decisive_samples", plan.decisive_samples()},
          {"trials", array_of(plan.trials(),
                              [&](const Trial& trial) -> Json {
                                return {{"body", plan.bodies[trial.body].name}, {"seed", trial.seed}};
                              })},
          {"resolution", plan.resolution},
          {"protrusion_tolerance", plan.protrusion_tolerance},
          {"unit", plan.unit == ErrorUnit::volume ? "volume" : "box"},
          {"motions", motion_names(plan)},
          {"rules", array_of(plan.rules, rule_name)},
          {"metrics", array_of(plan.metrics,
                               [](const OwnMetric& m) -> Json {
                                 return {{"name", m.name}, {"unit", m.unit}};
                               })},
          {"press",
           {{"pose", describe_all(plan.press_pose)},
            {"rules", array_of(plan.press_rules, rule_name)},
            {"amounts", plan.press_amounts},
            {"budgets", plan.press_budgets}}},
          {"sph_origin", name(plan.sph_origin)}};
}

Json body_json(const NamedMesh& body) {
  const MeshReport report = inspect(body.mesh);
  return {{"name", body.name},
          {"vertices", body.mesh.vertex_count()},
          {"facets", body.mesh.facet_count()},
          {"volume", report.has_volume() ? Json(report.volume) : Json(nullptr)}};
}

Json trial_json(const TrialVerdict& trial) {
  const auto verdict = [](const std::optional<Verdict>& v) { return v ? Json(name(*v)) : Json(nullptr); };
  return {{"body", trial.body},
          {"seed", trial.seed},
          {"verdict", name(trial.verdict)},
          {"true", trial.cases_true},
          {"cases", trial.cases},
          {"value", json_of(trial.value)},
          {"at_half_amount", verdict(trial.at_half_amount)},
          {"at_half_resolution", verdict(trial.at_half_resolution)},
          {"numbers", trial.numbers}};
}

Json stability_json(const std::optional<Stability>& stability) {
  if (!stability) return nullptr;
  return {{"seeds", stability->seeds},
          {"compared", stability->compared},
          {"same", stability->same},
          {"differing", stability->differing}};
}

Json claim_json(const Claim& claim) {
  Json json{{"id", claim.id},           {"source", name(claim.origin)},
            {"claim", claim.claim},     {"verdict", name(claim.verdict)},
            {"numbers", claim.numbers}, {"figures", claim.figures}};
  if (!claim.place.empty()) json["place"] = claim.place;
  if (!claim.times.empty()) json["times"] = claim.times;
  if (const std::string why = why_of(claim.id); !why.empty()) json["why"] = why;
  if (claim.adverse) json["adverse"] = true;
  if (claim.guarantee) json["guarantee"] = true;
  json["counts"] = {{"trials", claim.trials.size()},
                    {"holds", claim.count(Verdict::holds)},
                    {"partly", claim.count(Verdict::partly)},
                    {"fails", claim.count(Verdict::fails)}};
  if (!claim.quantity.name.empty()) json["quantity"] = claim.quantity.name;
  if (const std::optional<Interval>& v = claim.value)
    json["value"] = {{"mean", v->mean}, {"low", v->low}, {"high", v->high}, {"trials", v->trials}};
  if (const std::optional<Effect>& e = claim.effect)
    json["effect"] = {{"true", e->cases_true},
                      {"cases", e->cases},
                      {"cliffs_delta", e->cliffs_delta},
                      {"median_ratio", json_of(e->median_ratio)}};
  json["depends_on"] = {{"seed", json_of(claim.dependence.seed)},
                        {"body", json_of(claim.dependence.body)},
                        {"amount", json_of(claim.dependence.amount)},
                        {"resolution", json_of(claim.dependence.resolution)}};
  json["trials"] = array_of(claim.trials, trial_json);
  return json;
}

/// The look of a curve, the same as in the files: colors on light and dark pages, dashes in pixels.
Json style_json(const Series& series) {
  const toolbox::PlotLine line = style_of(series);
  const toolbox::Shade& shade = toolbox::palette[static_cast<std::size_t>(line.color)];
  return {{"light", fmt::format("#{:06x}", shade.light)},
          {"dark", fmt::format("#{:06x}", shade.dark)},
          {"dash", line.dash},
          {"marker", name(line.marker)},
          {"strong", line.strong},
          {"hollow", line.hollow},
          {"dots", line.dots}};
}

Json series_json(const Series& series) {
  Json json{{"name", series.name},
            {"x", series.x},
            {"y", array_of(series.y, json_of<double>)},
            {"role", name(series.role)},
            {"style", style_json(series)}};
  if (std::find(series.uncovered.begin(), series.uncovered.end(), true) != series.uncovered.end())
    json["uncovered"] = series.uncovered;
  return json;
}

Json figure_json(const Plan& plan, const Figure& figure) {
  Json json{{"id", figure.id}, {"title", figure.title}};
  if (!figure.note.empty()) json["note"] = figure.note;
  if (figure.x_names.empty()) {
    json["x"] = {{"label", "sample"}, {"unit", "of the motion"}};
  } else {
    json["x"] = {{"label", "query"}, {"unit", "contacts"}, {"names", figure.x_names}};
  }
  json["y"] = {{"label", figure.y_label}, {"unit", figure.y_unit}};
  if (figure.y_log) json["y"]["log"] = true;
  if (figure.y_end > 0) json["y"]["end"] = figure.y_end;
  json["frame_axis"] = figure.x_names.empty();
  json["motion"] = figure.motion;
  json["body"] = plan.bodies[figure.body].name;
  json["series"] = array_of(figure.series, series_json);
  return json;
}

Json value_json(const TableValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* count = std::get_if<std::size_t>(&value)) return *count;
  if (const auto* number = std::get_if<double>(&value)) return *number;
  return nullptr;
}

Json table_json(const Table& table) {
  Json json{{"id", table.id}, {"title", table.title}, {"note", table.note}};
  if (table.timed) json["timed"] = true;
  json["columns"] = table.columns;
  json["rows"] = array_of(table.rows, [](const std::vector<TableValue>& row) { return array_of(row, value_json); });
  return json;
}

Json cell_json(const Plan& plan, const std::vector<FollowRule>& rules, const MotionRun& cell) {
  Json samples = array_of(cell.samples, [&](const Sample& s) -> Json {
    Json levels = array_of(s.levels, [&](const LevelFigures& l) -> Json {
      Json json{{"level", l.level},
                {"spheres", l.spheres},
                {"looseness", json_of(l.looseness())},
                {"looseness_box", json_of(l.looseness_box())},
                {"looseness_half_grid", json_of(l.error_on_half_grid(ErrorUnit::volume))},
                {"looseness_fixed", json_of(l.looseness_fixed())},
                {"missed_volume", json_of(l.missed_volume())},
                {"uncovered_area", l.uncovered_area()},
                {"uncovered_distance", l.uncovered_distance()},
                {"protrusion_worst", json_of(l.protrusion_worst())},
                {"protrusion_mean", json_of(l.protrusion_mean())}};
      for (std::size_t i = 0; i < l.metrics.size(); ++i) json["metrics"][plan.metrics[i].name] = json_of(l.metrics[i]);
      return json;
    });
    return {{"sample", s.sample}, {"parameter", s.parameter}, {"levels", levels}};
  });
  return {{"body", plan.body_of(cell.key.source).name},
          {"method", plan.sources[cell.key.source].method},
          {"seed", json_of(plan.sources[cell.key.source].seed)},
          {"motion", plan.motion_name(cell.key.motion)},
          {"rule", rules[cell.key.rule].name},
          {"returns_to_rest", json_of(cell.returns_to_rest)},
          {"samples", samples}};
}

Json press_json(const Plan& plan, const PressCell& cell) {
  const Source& source = plan.pressed(cell.source);
  return {{"body", plan.bodies[source.body].name},
          {"method", source.method},
          {"seed", json_of(source.seed)},
          {"rule", plan.press_rules[cell.rule].name},
          {"figures", figures_json(cell)}};
}

/// The place of b and the true values there: sufficient input to reproduce them by `morula collide`.
Json truths_json(const Plan& plan, const PressScene& scene) {
  const auto vector = [](const Vec3& v) { return Json::array({v.x, v.y, v.z}); };
  Json truths = array_of(scene.truths, [&](const PressTruth& truth) -> Json {
    const Vec3 axis{truth.axis == Axis::x ? 1.0 : 0.0, truth.axis == Axis::y ? 1.0 : 0.0,
                    truth.axis == Axis::z ? 1.0 : 0.0};
    return {{"axis", name(truth.axis)},
            {"amount", truth.amount},
            {"turn_b", {{"axis", vector(axis)}, {"degrees", 90}}},
            {"place_b", vector(truth.transform.translation)},
            {"normal", vector(truth.normal)},
            {"depth", truth.depth / scene.diagonal},
            {"crossings", truth.crossings.size()}};
  });
  return {{"body", plan.bodies[scene.body].name}, {"truths", truths}};
}

Json cost_json(const Plan& plan, const Cost& cost) {
  Json json{{"note", "times: these, and what is marked timed, differ from run to run"},
            {"body", plan.bodies.front().name},
            {"method", plan.sources[cost.source].method},
            {"vertices", cost.vertices}};
  json.update(costs_json(cost));
  return json;
}

}  // namespace

std::string study_json(const Study& study) {
  const Plan& plan = study.plan;
  const Result& result = study.result;
  Json cells = array_of(result.cells, [&](const MotionRun& cell) { return cell_json(plan, plan.rules, cell); });
  for (const MotionRun& cell : result.mixes) cells.push_back(cell_json(plan, plan.mixes, cell));
  const Json json{
      {"morula", version},
      {"title", "Sphere trees on deforming bodies: the evaluation of Garcia, Bayona, Toharia and Mendoza, again"},
      {"settings", settings_json(plan)},
      {"bodies", array_of(plan.bodies, body_json)},
      {"summary", summary_of(study)},
      {"claims", array_of(study.claims, claim_json)},
      {"stability", stability_json(study.stability)},
      {"figures", array_of(study.figures, [&](const Figure& figure) { return figure_json(plan, figure); })},
      {"tables", array_of(study.tables, table_json)},
      {"pictures", array_of(study.pictures,
                            [](const Picture& p) -> Json {
                              return {{"id", p.id}, {"title", p.title}, {"svg", p.svg}};
                            })},
      {"skipped", array_of(result.skipped, [](const Skipped& skipped) { return skipped.reason; })},
      {"cells", cells},
      {"presses", array_of(result.presses, [&](const PressCell& press) { return press_json(plan, press); })},
      {"press_truths", array_of(result.scenes, [&](const PressScene& scene) { return truths_json(plan, scene); })},
      {"cost", cost_json(plan, study.cost)}};
  return json_text(json, 1) + "\n";
}

}  // namespace morula::study
