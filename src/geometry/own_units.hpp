// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes of sizes whose areas and volumes would vanish or overflow, in units of their own.
#pragma once

#include <cmath>
#include <morula/geometry/mesh.hpp>
#include <optional>

namespace morula {

struct OwnUnits {
  Mesh mesh;     // about its box's centre
  int exponent;  // the unit is 2^exponent
};

/// Nothing for meshes of ordinary size, which need it not: scaling by a power of two changes no digit.
inline std::optional<OwnUnits> in_own_units(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  // In halves, which do not overflow.
  const double size = largest_component(box.upper * 0.5 - box.lower * 0.5);
  constexpr int ordinary = 100;
  if (!(size > 0) || !std::isfinite(size) || std::abs(std::ilogb(size)) <= ordinary) return std::nullopt;
  OwnUnits own{mesh, std::ilogb(size)};
  const Vec3 middle = box.lower * 0.5 + box.upper * 0.5;
  const auto scaled = [&](double x) { return std::ldexp(x, -own.exponent); };
  for (Vec3& p : own.mesh.positions) p = {scaled(p.x - middle.x), scaled(p.y - middle.y), scaled(p.z - middle.z)};
  return own;
}

}  // namespace morula
