// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The few of many points that decide how large a ball around them must be: those farthest out along some directions.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

namespace morula::detail {

/// Points in columns, at least one, all of them finite.
struct PointColumns {
  std::span<const float> x, y, z;
};

/// found[d]: the point farthest along directions[d], the first of equals. Sums of products are in the order x, y, z.
/// Cost: points × directions, in registers.
void farthest_along(std::span<const Vec3f> directions, const PointColumns& points, std::span<std::uint32_t> found);

}  // namespace morula::detail
