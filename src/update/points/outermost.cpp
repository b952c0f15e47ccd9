// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/points/outermost.hpp"

#include <algorithm>
#include <limits>
#include <morula/geometry/sampling.hpp>
#include <vector>

namespace morula {

void outermost(std::span<const LocalPoint> points, std::span<const std::uint32_t> owned, const Vec3f& center,
               std::span<std::uint32_t> core) {
  constexpr std::size_t farthest_count = 4;
  std::vector<Vec3f> directions;
  for (const Vec3& d : fibonacci_directions(core.size() - farthest_count)) directions.emplace_back(d);
  std::vector<float> height(core.size(), -std::numeric_limits<float>::infinity());
  const std::span<float> farthest = std::span(height).subspan(directions.size());
  const std::span<std::uint32_t> farthest_points = core.subspan(directions.size());
  constexpr std::uint32_t none = 0xffffffffu;
  std::fill(core.begin(), core.end(), none);
  for (const std::uint32_t p : owned) {
    const Vec3f out = Vec3f{points[p].x, points[p].y, points[p].z} - center;
    for (std::size_t d = 0; d < directions.size(); ++d)
      if (const float h = dot(directions[d], out); h > height[d]) height[d] = h, core[d] = p;
    // The few that are farthest so far, in descending order. A region names a point more than once.
    const float squared = squared_length(out);
    if (squared <= farthest.back() || std::count(farthest_points.begin(), farthest_points.end(), p) > 0) continue;
    std::size_t at = farthest_count - 1;
    for (; at > 0 && farthest[at - 1] < squared; --at)
      farthest[at] = farthest[at - 1], farthest_points[at] = farthest_points[at - 1];
    farthest[at] = squared, farthest_points[at] = p;
  }
  std::replace(core.begin(), core.end(), none, owned.front());  // there were fewer
}

}  // namespace morula
