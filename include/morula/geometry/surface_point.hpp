// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A point of a surface: its facet, where on it, and where in space.
#pragma once

#include <cstdint>
#include <morula/geometry/triangle.hpp>

namespace morula {

/// `point` is at_barycentric of the facet's triangle up to rounding: in mesh units of the mesh, or of the world where a
/// collider is asked.
struct SurfacePoint {
  std::uint32_t facet;
  Barycentric barycentric;
  Vec3 point;
};

}  // namespace morula
