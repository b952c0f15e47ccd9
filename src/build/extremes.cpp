// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "build/extremes.hpp"

#include <algorithm>
#include <limits>
#include <morula/geometry/sampling.hpp>

namespace morula {

GroupPoints extremes(std::span<const Vec3> points, const OutsideGrid& grid) {
  // Corners of many patches repeat and lie close together: an even choice decides nearly as well, and radii are taken
  // from all of them in the end.
  constexpr std::size_t most = 1200, few_enough = 200, direction_count = 96;
  GroupPoints all;
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / most) all.push_back(grid.to_grid(points[i]));
  if (all.size() <= few_enough) return all;
  static const std::vector<Vec3> directions = fibonacci_directions(direction_count);
  std::vector<std::uint32_t> chosen;
  for (const Vec3& d : directions) {
    const float dx = static_cast<float>(d.x), dy = static_cast<float>(d.y), dz = static_cast<float>(d.z);
    float farthest = -std::numeric_limits<float>::infinity();
    std::uint32_t at = 0;
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      const float v = all.x[i] * dx + all.y[i] * dy + all.z[i] * dz;
      if (v > farthest) farthest = v, at = i;
    }
    chosen.push_back(at);
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  GroupPoints few;
  for (const std::uint32_t i : chosen) few.push_back(all[i]);
  return few;
}

}  // namespace morula
