// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/outermost.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <morula/geometry/sampling.hpp>
#include <vector>

#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {

namespace {
constexpr std::size_t farthest_count = 4;
}  // namespace

void outermost(std::span<const LocalPoint> points, std::span<const std::uint32_t> owned, const Vec3f& center,
               std::span<std::uint32_t> core) {
  constexpr std::uint32_t none = 0xffffffffu;
  std::vector<Vec3f> directions;
  for (const Vec3& d : fibonacci_directions(core.size() - farthest_count)) directions.emplace_back(d);
  std::vector<float> x, y, z;
  x.reserve(owned.size()), y.reserve(owned.size()), z.reserve(owned.size());
  std::array<float, farthest_count> farthest;
  farthest.fill(-std::numeric_limits<float>::infinity());
  const std::span<std::uint32_t> farthest_points = core.subspan(directions.size());
  std::fill(farthest_points.begin(), farthest_points.end(), none);
  for (const std::uint32_t p : owned) {
    const Vec3f out = Vec3f{points[p].x, points[p].y, points[p].z} - center;
    x.push_back(out.x), y.push_back(out.y), z.push_back(out.z);
    // The few farthest points so far, in descending order. A region may have a point more than once.
    const float squared = squared_length(out);
    if (squared <= farthest.back() || std::count(farthest_points.begin(), farthest_points.end(), p) > 0) continue;
    std::size_t at = farthest_count - 1;
    for (; at > 0 && farthest[at - 1] < squared; --at)
      farthest[at] = farthest[at - 1], farthest_points[at] = farthest_points[at - 1];
    farthest[at] = squared, farthest_points[at] = p;
  }
  std::replace(farthest_points.begin(), farthest_points.end(), none, owned.front());  // there were fewer
  const std::span<std::uint32_t> along = core.first(directions.size());
  farthest_along(directions, {x.data(), y.data(), z.data(), x.size()}, along);
  for (std::uint32_t& p : along) p = owned[p];
}

}  // namespace morula::detail
