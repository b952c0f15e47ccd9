// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "commands/robot_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "shared/figures.hpp"
#include "shared/table.hpp"

namespace morula::cli {

using robot::IgnoreReason;

std::string robot_table(const robot::Robot& robot, const robot::RobotSpheres& spheres) {
  Table table(
      {"link", "facets", "spheres", "gap", "protrusion mean", "p95", "max", "outside volume", "union volume", "mass"});
  const auto or_na = [](const std::optional<double>& value) { return value ? figure(*value) : "n/a"; };
  double outside = 0, all = 0, mass = 0, worst = 0;
  for (const robot::LinkSpheres& link : spheres.links) {
    const robot::LinkFigures& f = link.figures;
    table.add({robot.links[link.link].name, fmt::format("{}", f.facets), fmt::format("{}", link.spheres.size()),
               f.covered ? "0, proven" : figure(f.gap), figure(f.protrusion_mean), figure(f.protrusion_p95),
               figure(f.protrusion_max), or_na(f.outside_volume), figure(f.solid.volume), figure(f.mass)});
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

Json robot_links_json(const robot::Robot& robot, const robot::RobotSpheres& spheres) {
  Json links = Json::array();
  const auto or_null = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  for (const robot::LinkSpheres& link : spheres.links) {
    const robot::LinkFigures& f = link.figures;
    const double scale = f.solid.volume > 0 ? f.mass / f.solid.volume : 0;
    Json inertia = Json::array();
    for (const double entry : f.solid.inertia) inertia.push_back(scale * entry);
    links.push_back(
        {{"link", robot.links[link.link].name},
         {"alike", link.alike == robot::none ? Json(nullptr) : Json(robot.links[link.alike].name)},
         {"facets", f.facets},
         {"spheres", link.spheres.size()},
         {"covered", f.covered},
         {"gap", f.gap},
         {"protrusion", {{"mean", f.protrusion_mean}, {"p95", f.protrusion_p95}, {"max", f.protrusion_max}}},
         {"object_volume", or_null(f.object_volume)},
         {"outside_volume", or_null(f.outside_volume)},
         {"union_volume", f.solid.volume},
         {"mass", f.mass},
         {"center_of_mass", {f.solid.center.x, f.solid.center.y, f.solid.center.z}},
         {"inertia", inertia}});
  }
  return links;
}

std::string ignored_text(const robot::SelfCollision& self_collision) {
  const auto count = [&](IgnoreReason reason) {
    return static_cast<std::size_t>(std::count_if(self_collision.ignored.begin(), self_collision.ignored.end(),
                                                  [&](const auto& pair) { return pair.reason == reason; }));
  };
  std::vector<std::string> parts;
  if (count(IgnoreReason::given) > 0) parts.push_back(fmt::format("{} given", count(IgnoreReason::given)));
  parts.push_back(counted(count(IgnoreReason::adjacent), "neighbour"));
  parts.push_back(fmt::format("{} touching at rest", count(IgnoreReason::rest)));
  if (self_collision.samples > 0) {
    parts.push_back(
        fmt::format("{} never met in {}", count(IgnoreReason::never), counted(self_collision.samples, "sample")));
  }
  return fmt::format("{} of {}: {}", self_collision.ignored.size(), counted(self_collision.pairs, "pair"),
                     fmt::join(parts, ", "));
}

Json ignored_json(const robot::Robot& robot, const robot::SelfCollision& self_collision) {
  Json ignored = Json::array();
  for (const robot::IgnoredPair& pair : self_collision.ignored) {
    ignored.push_back({{"links", {robot.links[pair.a].name, robot.links[pair.b].name}}, {"reason", name(pair.reason)}});
  }
  return {{"samples", self_collision.samples}, {"pairs", self_collision.pairs}, {"ignored", ignored}};
}

}  // namespace morula::cli
