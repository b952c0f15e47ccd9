// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "geometry/enclosing/farthest_along.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace morula::detail {

void farthest_along(std::span<const Vec3f> directions, const PointColumns& points, std::span<std::uint32_t> found) {
  const std::size_t count = points.x.size();
  const float *x = points.x.data(), *y = points.y.data(), *z = points.z.data();
  std::vector<float> heights(count);
  for (std::size_t d = 0; d < directions.size(); ++d) {
    const float dx = directions[d].x, dy = directions[d].y, dz = directions[d].z;
    for (std::size_t i = 0; i < count; ++i) heights[i] = x[i] * dx + y[i] * dy + z[i] * dz;
    // The greatest first, in lanes, then where it is: a search for both at once stays scalar.
    constexpr std::size_t lanes = 8;
    std::array<float, lanes> most_of_lane;
    most_of_lane.fill(heights[0]);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes)
      for (std::size_t l = 0; l < lanes; ++l)
        most_of_lane[l] = heights[i + l] > most_of_lane[l] ? heights[i + l] : most_of_lane[l];
    float greatest = *std::max_element(most_of_lane.begin(), most_of_lane.end());
    for (; i < count; ++i) greatest = std::max(greatest, heights[i]);
    found[d] = static_cast<std::uint32_t>(std::find(heights.begin(), heights.end() - 1, greatest) - heights.begin());
  }
}

}  // namespace morula::detail
