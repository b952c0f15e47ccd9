// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/fit_options.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace morula::robot {

void require_fit_options(const Robot& robot, const FitOptions& o) {
  const auto require_link = [&](const std::string& name, const char* what) {
    if (robot.find_link(name) == none)
      throw std::invalid_argument(fmt::format("{}: the robot has no link {}", what, name));
  };
  for (const std::string& name : o.skip) require_link(name, "skip");
  for (const auto& [name, count] : o.link_spheres) {
    require_link(name, "link_spheres");
    if (count == 0) throw std::invalid_argument(fmt::format("link_spheres: 0 of link {}; skip the link instead", name));
  }
  for (const auto& [name, spheres] : o.fixed_spheres) {
    require_link(name, "fixed_spheres");
    if (spheres.empty())
      throw std::invalid_argument(fmt::format("fixed_spheres: link {} has none; skip the link instead", name));
  }
  for (const auto& [name, planes] : o.clip) {
    require_link(name, "clip");
    for (const ClipPlane& plane : planes) {
      if (!(std::abs(length(plane.normal) - 1) < 1e-9) || !(std::abs(plane.offset) < 1e30)) {
        throw std::invalid_argument(fmt::format("clip: the normal of a plane of link {} is not of length 1", name));
      }
    }
  }
  const auto require_not_below_0 = [](const char* argument, double value) {
    if (!(value >= 0 && value < 1e30))
      throw std::invalid_argument(fmt::format("{}: {} is not a number from 0 on", argument, value));
  };
  const auto require_above_0 = [](const char* argument, const std::optional<double>& value) {
    if (value && !(*value > 0 && *value < 1e30))
      throw std::invalid_argument(fmt::format("{}: {} is not a number above 0", argument, *value));
  };
  require_not_below_0("tolerance", o.tolerance);
  if (o.tolerance > 0 && o.method != Method::optimized) {
    throw std::invalid_argument(fmt::format(
        "method {} does not fit for a tolerance; use optimized, or leave the tolerance out", name(o.method)));
  }
  require_not_below_0("padding", o.padding);
  require_not_below_0("min_radius", o.min_radius);
  require_above_0("max_radius", o.max_radius);
  require_above_0("max_protrusion", o.max_protrusion);
  require_above_0("max_protrusion_share", o.max_protrusion_share);
  require_above_0("clip_margin", o.clip_margin);
  require_above_0("density", o.density);
  if (o.max_total && *o.max_total == 0) throw std::invalid_argument("max_total: a robot has at least 1 sphere");
  if (o.max_radius && *o.max_radius < o.min_radius) {
    throw std::invalid_argument(fmt::format("max_radius: {} is below min_radius, {}", *o.max_radius, o.min_radius));
  }
  if (o.method != Method::optimized && o.quality && *o.quality != Quality::standard) {
    throw std::invalid_argument(
        fmt::format("quality {} is for method optimized; method {} has one way only: leave the quality out",
                    name(*o.quality), name(o.method)));
  }
  if (o.spheres && *o.spheres == 0 && !o.max_total && !o.max_protrusion && !o.max_protrusion_share) {
    throw std::invalid_argument("spheres: 0 requires max_protrusion or max_protrusion_share");
  }
}

}  // namespace morula::robot
