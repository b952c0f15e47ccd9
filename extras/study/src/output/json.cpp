// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// study.json.
#include "json.hpp"

#include <morula/geometry/inspect.hpp>
#include <morula/study/study.hpp>
#include <morula/version.hpp>

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
          {"seed", plan.seed},
          {"resolution", plan.resolution},
          {"protrusion_tolerance", plan.protrusion_tolerance},
          {"unit", plan.unit == ErrorUnit::volume ? "volume" : "box"},
          {"motions", array_of(plan.motions, describe_all)},
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

Json claim_json(const Claim& claim) {
  Json json{{"id", claim.id},           {"source", name(claim.origin)},
            {"claim", claim.claim},     {"verdict", name(claim.verdict)},
            {"numbers", claim.numbers}, {"figures", claim.figures}};
  if (claim.timed) json["timed"] = true;
  if (claim.adverse) json["adverse"] = true;
  if (claim.guarantee) json["guarantee"] = true;
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
  json["series"] = array_of(figure.series, [](const Series& s) -> Json {
    return {{"name", s.name}, {"x", s.x}, {"y", array_of(s.y, json_of<double>)}, {"role", name(s.role)}};
  });
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
          {"motion", describe_all(plan.motions[cell.key.motion])},
          {"rule", rules[cell.key.rule].name},
          {"returns_to_rest", json_of(cell.returns_to_rest)},
          {"samples", samples}};
}

Json press_json(const Plan& plan, const PressCell& cell) {
  const Source& source = plan.pressed(cell.source);
  return {{"body", plan.bodies[source.body].name},
          {"method", source.method},
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
      {"claims", array_of(study.claims, claim_json)},
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
