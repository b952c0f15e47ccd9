// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A point on a body's surface, as a solver needs it to scatter a force onto vertices.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <morula/query/power_diagram.hpp>

namespace morula {

struct SurfacePoint {
  std::uint32_t facet;
  Barycentric barycentric;
  Vec3 point;
};

}  // namespace morula
