// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The report of morula robot on the links: a table, and JSON.
#pragma once

#include <morula/robot/output.hpp>
#include <morula/robot/self_fit.hpp>
#include <span>
#include <string>

#include "shared/report.hpp"

namespace morula::cli {

/// Per link: spheres, uncovered distance, protrusion, volumes, mass.
std::string robot_table(const robot::Robot& robot, const robot::RobotSpheres& spheres);
/// "base: spheres reach at most 0.01 beyond the plane", for every link with clip planes.
std::vector<std::string> clip_lines(const robot::Robot& robot, const robot::RobotSpheres& spheres);
/// "120 inner spheres, each proven to be inside its link, fill 0.012 of 0.016, the volume of the links".
std::string inner_text(const robot::RobotSpheres& spheres);
/// The outside volume of a robot that was fitted for a tolerance.
struct ToleranceRow {
  double tolerance = 0, within = 0;  ///< requested and proven
  std::size_t spheres = 0;
  double outside_volume = 0;  ///< of all links whose outside volume is known
  double uncovered_share = 0;
};
ToleranceRow tolerance_row(double tolerance, const robot::RobotSpheres& spheres);
std::string tolerance_table(std::span<const ToleranceRow> rows);
Json tolerances_json(std::span<const ToleranceRow> rows);
Json robot_links_json(const robot::Robot& robot, const robot::RobotSpheres& spheres);
/// "12 of 55 pairs: 10 neighbors, 2 proven apart, …".
std::string ignored_text(const robot::SelfCollision& self_collision);
Json ignored_json(const robot::Robot& robot, const robot::SelfCollision& self_collision);
/// False self-collisions: the rates, the worst pairs, and the rates of more spheres.
std::vector<std::string> self_fit_lines(const robot::Robot& robot, const robot::SelfFit& fit);
Json self_fit_json(const robot::Robot& robot, const robot::SelfFit& fit);

}  // namespace morula::cli
