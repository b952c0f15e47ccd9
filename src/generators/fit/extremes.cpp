// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/extremes.hpp"

#include <algorithm>
#include <array>
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
  std::vector<float> heights(all.size());
  for (const Vec3& d : directions) {
    const float dx = static_cast<float>(d.x), dy = static_cast<float>(d.y), dz = static_cast<float>(d.z);
    const float *x = all.x.data(), *y = all.y.data(), *z = all.z.data();
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = x[i] * dx + y[i] * dy + z[i] * dz;
    // The greatest first, in lanes, then where it is: a search for both at once stays scalar.
    constexpr std::size_t lanes = 8;
    std::array<float, lanes> most_of_lane;
    most_of_lane.fill(heights[0]);
    std::size_t i = 0;
    for (; i + lanes <= heights.size(); i += lanes)
      for (std::size_t l = 0; l < lanes; ++l)
        most_of_lane[l] = heights[i + l] > most_of_lane[l] ? heights[i + l] : most_of_lane[l];
    float greatest = *std::max_element(most_of_lane.begin(), most_of_lane.end());
    for (; i < heights.size(); ++i) greatest = std::max(greatest, heights[i]);
    const auto at = std::find(heights.begin(), heights.end(), greatest);
    if (at != heights.end()) chosen.push_back(static_cast<std::uint32_t>(at - heights.begin()));
  }
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  GroupPoints few;
  for (const std::uint32_t i : chosen) few.push_back(all[i]);
  return few;
}

}  // namespace morula
