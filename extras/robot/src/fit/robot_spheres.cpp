// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/inspect.hpp>
#include <morula/robot/fit.hpp>

namespace morula::robot {

std::size_t RobotSpheres::sphere_count() const {
  std::size_t count = 0;
  for (const LinkSpheres& link : links) count += link.spheres.size();
  return count;
}

bool RobotSpheres::covered() const {
  return std::all_of(links.begin(), links.end(), [](const LinkSpheres& link) { return link.figures.covered; });
}

double RobotSpheres::within() const {
  double largest = 0;
  for (const LinkSpheres& link : links) largest = std::max(largest, link.figures.within);
  return largest;
}

double RobotSpheres::uncovered_share() const {
  double uncovered = 0, all = 0;
  for (const LinkSpheres& link : links) {
    const double area = inspect(link.surface.mesh).area;
    uncovered += area * link.figures.uncovered_share;
    all += area;
  }
  return all > 0 ? uncovered / all : 0;
}

std::size_t RobotSpheres::inner_count() const {
  std::size_t count = 0;
  for (const LinkSpheres& link : links) count += link.inner.size();
  return count;
}

RobotSpheres RobotSpheres::with_inner_spheres() const {
  RobotSpheres result;
  result.notes = notes;
  result.visual = visual;
  for (const LinkSpheres& link : links) {
    if (link.inner.empty()) {
      result.notes.insert(result.notes.end(), link.notes.begin(), link.notes.end());
      continue;
    }
    result.links.push_back(link);
    result.links.back().spheres = link.inner;
  }
  return result;
}

const LinkSpheres* RobotSpheres::of(std::size_t link) const {
  for (const LinkSpheres& spheres : links) {
    if (spheres.link == link) return &spheres;
  }
  return nullptr;
}

}  // namespace morula::robot
