// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes whose areas and volumes would underflow or overflow, in units of their own.
#pragma once

#include <cmath>
#include <cstdlib>
#include <morula/geometry/mesh_view.hpp>
#include <vector>

namespace morula::detail {

/// Meshes of ordinary size are unchanged and need no copy: scaling by a power of two changes no digit. Others have
/// their vertices about the box's center.
class OwnUnits {
 public:
  /// box: the box of the mesh.
  OwnUnits(const MeshView& mesh, const Box& box) : view_(mesh), box_(box) {
    // Halves are subtracted, because they do not overflow.
    const double size = max_norm(box.upper * 0.5 - box.lower * 0.5);
    constexpr int ordinary = 100;
    if (!(size > 0) || !std::isfinite(size) || std::abs(std::ilogb(size)) <= ordinary) return;
    exponent_ = std::ilogb(size);
    const Vec3 middle = box.lower * 0.5 + box.upper * 0.5;
    const auto scaled = [&](const Vec3& p) {
      return Vec3{std::ldexp(p.x - middle.x, -exponent_), std::ldexp(p.y - middle.y, -exponent_),
                  std::ldexp(p.z - middle.z, -exponent_)};
    };
    positions_.reserve(mesh.vertex_count());
    for (std::size_t v = 0; v < mesh.vertex_count(); ++v) positions_.push_back(scaled(mesh.positions[v]));
    view_.positions = positions_;
    box_ = {scaled(box.lower), scaled(box.upper)};
  }
  OwnUnits(const OwnUnits&) = delete;
  OwnUnits& operator=(const OwnUnits&) = delete;

  const MeshView& mesh() const { return view_; }
  const Box& box() const { return box_; }
  /// The exponent of the unit, 2^exponent.
  int exponent() const { return exponent_; }

 private:
  MeshView view_;
  Box box_;
  int exponent_ = 0;
  std::vector<Vec3> positions_;
};

double surface_area(const OwnUnits& own);
double signed_volume(const OwnUnits& own);

}  // namespace morula::detail
