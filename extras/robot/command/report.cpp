// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {

using robot::IgnoreReason;

std::string robot_table(const robot::Robot& robot, const robot::RobotSpheres& spheres) {
  Table table({"link", "facets", "spheres", "uncovered distance", "protrusion mean", "p95", "max", "outside volume",
               "union volume", "mass"});
  const auto or_na = [](const std::optional<double>& value) { return value ? figure(*value) : "n/a"; };
  double outside = 0, all = 0, mass = 0, worst = 0;
  for (const robot::LinkSpheres& link : spheres.links) {
    const robot::LinkFigures& f = link.figures;
    table.add({robot.links[link.link].name, fmt::format("{}", f.facets), fmt::format("{}", link.spheres.size()),
               f.covered ? "0, proven" : figure(f.uncovered_distance), figure(f.protrusion_mean),
               figure(f.protrusion_p95), figure(f.protrusion_max), or_na(f.outside_volume), figure(f.solid.volume),
               figure(f.mass)});
    outside += f.outside_volume.value_or(0);
    all += f.solid.volume;
    mass += f.mass;
    worst = std::max(worst, f.protrusion_max);
  }
  table.add_rule();
  table.add({"all", "", fmt::format("{}", spheres.sphere_count()), spheres.covered() ? "0, proven" : "", "", "",
             figure(worst), figure(outside), figure(all), figure(mass)});
  return table.text();
}

ToleranceRow tolerance_row(double tolerance, const robot::RobotSpheres& spheres) {
  ToleranceRow row{tolerance, spheres.within(), spheres.sphere_count(), 0, spheres.uncovered_share()};
  for (const robot::LinkSpheres& link : spheres.links) row.outside_volume += link.figures.outside_volume.value_or(0);
  return row;
}

std::string tolerance_table(std::span<const ToleranceRow> rows) {
  Table table({"tolerance", "proven within", "spheres", "outside volume", "uncovered share"});
  for (const ToleranceRow& row : rows) {
    table.add({figure(row.tolerance), figure(row.within), fmt::format("{}", row.spheres), figure(row.outside_volume),
               figure(row.uncovered_share)});
  }
  return table.text();
}

Json tolerances_json(std::span<const ToleranceRow> rows) {
  Json json = Json::array();
  for (const ToleranceRow& row : rows) {
    json.push_back({{"tolerance", row.tolerance},
                    {"within", row.within},
                    {"spheres", row.spheres},
                    {"outside_volume", row.outside_volume},
                    {"uncovered_share", row.uncovered_share}});
  }
  return json;
}

Json robot_links_json(const robot::Robot& robot, const robot::RobotSpheres& spheres) {
  Json links = Json::array();
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  for (const robot::LinkSpheres& link : spheres.links) {
    const robot::LinkFigures& f = link.figures;
    const double scale = f.solid.volume > 0 ? f.mass / f.solid.volume : 0;
    Json inertia = Json::array();
    for (const double entry : f.solid.inertia) inertia.push_back(scale * entry);
    Json json({{"link", robot.links[link.link].name},
               {"same_shape_as",
                link.same_shape_as == robot::none ? Json(nullptr) : Json(robot.links[link.same_shape_as].name)},
               {"facets", f.facets},
               {"spheres", link.spheres.size()},
               {"covered", f.covered},
               {"within", f.within},
               {"uncovered_share", f.uncovered_share},
               {"uncovered_distance", f.uncovered_distance},
               {"protrusion", {{"mean", f.protrusion_mean}, {"p95", f.protrusion_p95}, {"max", f.protrusion_max}}},
               {"object_volume", or_null(f.object_volume)},
               {"outside_volume", or_null(f.outside_volume)},
               {"union_volume", f.solid.volume},
               {"mass", f.mass},
               {"center_of_mass", {f.solid.center.x, f.solid.center.y, f.solid.center.z}},
               {"inertia", inertia}});
    if (f.beyond_clip) json["beyond_clip"] = *f.beyond_clip;
    if (spheres.inner_count() > 0) {
      json["inner_spheres"] = link.inner.size();
      json["inner_volume"] = link.inner_volume;
    }
    links.push_back(std::move(json));
  }
  return links;
}

std::vector<std::string> clip_lines(const robot::Robot& robot, const robot::RobotSpheres& spheres) {
  std::vector<std::string> lines;
  for (const robot::LinkSpheres& link : spheres.links) {
    if (!link.figures.beyond_clip) continue;
    const std::string& name = robot.links[link.link].name;
    const double beyond = *link.figures.beyond_clip;
    lines.push_back(beyond > 0 ? fmt::format("{}: spheres reach at most {} beyond", name, figure(beyond))
                               : fmt::format("{}: no sphere reaches beyond", name));
  }
  return lines;
}

std::string inner_text(const robot::RobotSpheres& spheres) {
  if (spheres.inner_count() == 0) return "no sphere: no link has a closed surface";
  double filled = 0, all = 0;
  bool known = true;
  for (const robot::LinkSpheres& link : spheres.links) {
    filled += link.inner_volume;
    known = known && link.figures.object_volume.has_value();
    all += link.figures.object_volume.value_or(0);
  }
  const std::string part = known ? fmt::format("{} of {}, the volume of the links", figure(filled), figure(all))
                                 : fmt::format("{}", figure(filled));
  return fmt::format("{}, each proven to be inside its link, fill {}", counted(spheres.inner_count(), "inner sphere"),
                     part);
}

std::string ignored_text(const robot::SelfCollision& self_collision) {
  const auto count = [&](IgnoreReason reason) {
    return static_cast<std::size_t>(std::count_if(self_collision.ignored.begin(), self_collision.ignored.end(),
                                                  [&](const auto& pair) { return pair.reason == reason; }));
  };
  std::vector<std::string> parts;
  if (count(IgnoreReason::given) > 0) parts.push_back(fmt::format("{} given", count(IgnoreReason::given)));
  parts.push_back(counted(count(IgnoreReason::adjacent), "neighbor"));
  parts.push_back(fmt::format("{} touching at rest", count(IgnoreReason::rest)));
  parts.push_back(fmt::format("{} proven apart", count(IgnoreReason::apart)));
  if (self_collision.samples > 0 && count(IgnoreReason::never) == 0) {
    parts.push_back(fmt::format("0 apart in {}", counted(self_collision.samples, "sample")));
  } else if (self_collision.samples > 0) {
    parts.push_back(fmt::format("{} apart in {} (each meets in less than {:.2g} of all, 95 %)",
                                count(IgnoreReason::never), counted(self_collision.samples, "sample"),
                                self_collision.never_bound()));
  }
  return fmt::format("{} of {}: {}", self_collision.ignored.size(), counted(self_collision.pairs, "pair"),
                     fmt::join(parts, ", "));
}

Json ignored_json(const robot::Robot& robot, const robot::SelfCollision& self_collision) {
  const auto names = [&](std::size_t a, std::size_t b) { return Json{robot.links[a].name, robot.links[b].name}; };
  Json ignored = Json::array(), overlapping = Json::array();
  for (const robot::IgnoredPair& pair : self_collision.ignored) {
    Json json{{"links", names(pair.a, pair.b)}, {"reason", name(pair.reason)}};
    if (pair.reason == IgnoreReason::apart || pair.reason == IgnoreReason::never) {
      const bool proven = pair.reason == IgnoreReason::apart;
      json["proven"] = proven;
      json["meets_below"] = proven ? 0.0 : self_collision.never_bound();
    }
    ignored.push_back(std::move(json));
  }
  for (const robot::OverlappingPair& pair : self_collision.overlapping) {
    overlapping.push_back({{"links", names(pair.a, pair.b)},
                           {"rest_distance", pair.rest_distance ? Json(*pair.rest_distance) : Json(nullptr)},
                           {"share", pair.share}});
  }
  return {{"samples", self_collision.samples},
          {"pairs", self_collision.pairs},
          {"ignored", ignored},
          {"overlapping", overlapping}};
}

std::vector<std::string> self_fit_lines(const robot::Robot& robot, const robot::SelfFit& fit) {
  std::vector<std::string> lines{fmt::format(
      "{:.1f} % of {} configurations collide by spheres alone, {:.1f} % by shapes; {:.1f} % with the same "
      "number of spheres placed by volume",
      100 * fit.rates.false_share, fit.rates.samples, 100 * fit.rates.surfaces, 100 * fit.evenly.false_share)};
  constexpr std::size_t most_pairs = 5;
  std::size_t shown = 0;
  for (const robot::SelfPairRate& pair : fit.rates.pairs) {
    const std::string names = fmt::format("{}-{}", robot.links[pair.a].name, robot.links[pair.b].name);
    if (pair.always_collides) {
      lines.push_back(fmt::format("{}: always collide, by shapes in {:.1f} %; the pair does not count", names,
                                  100 * pair.surfaces));
    } else if (pair.false_share > 0 && ++shown <= most_pairs) {
      lines.push_back(
          fmt::format("{}: {:.1f} % by spheres, {:.1f} % by shapes", names, 100 * pair.spheres, 100 * pair.surfaces));
    }
  }
  if (!fit.steps.empty() && fit.steps.back().spheres > fit.spheres.sphere_count()) {
    lines.push_back(
        fmt::format("{} spheres would leave {:.1f} %", fit.steps.back().spheres, 100 * fit.steps.back().false_share));
  }
  return lines;
}

Json self_fit_json(const robot::Robot& robot, const robot::SelfFit& fit) {
  const auto rates_json = [&](const robot::SelfRates& rates) {
    Json pairs = Json::array();
    for (const robot::SelfPairRate& pair : rates.pairs) {
      pairs.push_back({{"links", Json{robot.links[pair.a].name, robot.links[pair.b].name}},
                       {"spheres", pair.spheres},
                       {"surfaces", pair.surfaces},
                       {"false_share", pair.false_share},
                       {"always_collide", pair.always_collides}});
    }
    return Json{{"samples", rates.samples},
                {"spheres", rates.spheres},
                {"surfaces", rates.surfaces},
                {"false_share", rates.false_share},
                {"pairs", pairs}};
  };
  Json steps = Json::array();
  for (const robot::SelfFitStep& step : fit.steps)
    steps.push_back({{"spheres", step.spheres}, {"false_share", step.false_share}});
  Json json = rates_json(fit.rates);
  json["evenly"] = rates_json(fit.evenly);
  json["steps"] = steps;
  return json;
}

}  // namespace morula::cli
