// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <morula/geometry/reproducible.hpp>
#include <vector>

#include "update/points/local_points.hpp"

namespace morula::test {

/// Coordinates of up to this magnitude.
inline std::vector<detail::LocalPoint> random_points(std::size_t count, double magnitude, std::uint64_t seed) {
  Random random(seed);
  std::vector<detail::LocalPoint> points(count);
  for (detail::LocalPoint& p : points)
    p = {static_cast<float>(random.uniform(-magnitude, magnitude)),
         static_cast<float>(random.uniform(-magnitude, magnitude)),
         static_cast<float>(random.uniform(-magnitude, magnitude)), 0.0f};
  return points;
}

}  // namespace morula::test
