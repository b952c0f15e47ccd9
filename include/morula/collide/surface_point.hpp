// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A point of a body's surface, by facet.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <morula/query/power_diagram.hpp>

namespace morula {

/// point: in the world, at_barycentric of the collider's triangle up to rounding.
struct SurfacePoint {
  std::uint32_t facet;
  Barycentric barycentric;
  Vec3 point;
};

}  // namespace morula
