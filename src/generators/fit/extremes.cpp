// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/extremes.hpp"

#include <algorithm>
#include <morula/geometry/sampling.hpp>

#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {
namespace {

template <class Narrow>
GroupPoints farthest_out(std::span<const Vec3> points, const Narrow& narrow) {
  constexpr std::size_t few_enough = 200, direction_count = 96;
  const std::size_t step = points.size() <= most_candidates ? 1 : 1 + points.size() / most_candidates;
  GroupPoints all;
  for (std::size_t i = 0; i < points.size(); i += step) all.push_back(narrow(points[i]));
  if (all.size() <= few_enough) return all;
  static const std::vector<Vec3f> directions = [] {
    std::vector<Vec3f> result;
    for (const Vec3& d : fibonacci_directions(direction_count)) result.emplace_back(d);
    return result;
  }();
  std::vector<std::uint32_t> chosen(directions.size());
  farthest_along(directions, all.columns(), chosen);
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  GroupPoints few;
  for (const std::uint32_t i : chosen) few.push_back(all[i]);
  return few;
}

}  // namespace

GroupPoints extremes(std::span<const Vec3> points, const OutsideGrid& grid) {
  return farthest_out(points, [&](const Vec3& p) { return grid.to_grid(p); });
}

GroupPoints extremes(std::span<const Vec3> points, const FreeSpace& space) {
  return farthest_out(points, [&](const Vec3& p) { return space.to_cells(p); });
}

}  // namespace morula::detail
