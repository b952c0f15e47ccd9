// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/tool_pose.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/geometry/reproducible.hpp>

namespace morula::detail {
namespace {

Rotation unit(double w, const Vec3& v) {
  const double size = std::sqrt(w * w + squared_length(v));
  return {w / size, v / size};
}

}  // namespace

// Four times a component times all components, for the largest component.
Rotation Rotation::from_rows(const RigidTransform& t) {
  const auto& [x, y, z] = t.rows;
  const std::array<double, 4> squares{1 + x.x + y.y + z.z, 1 + x.x - y.y - z.z, 1 - x.x + y.y - z.z,
                                      1 - x.x - y.y + z.z};
  const Vec3 difference{z.y - y.z, x.z - z.x, y.x - x.y}, sum{z.y + y.z, x.z + z.x, y.x + x.y};
  switch (std::max_element(squares.begin(), squares.end()) - squares.begin()) {
    case 0:
      return unit(squares[0], difference);
    case 1:
      return unit(difference.x, {squares[1], sum.z, sum.y});
    case 2:
      return unit(difference.y, {sum.z, squares[2], sum.x});
    default:
      return unit(difference.z, {sum.y, sum.x, squares[3]});
  }
}

Rotation Rotation::from_vector(const Vec3& turn) {
  const double angle = length(turn);
  if (!(angle > 0)) return {};
  const auto [sin, cos] = sin_cos(angle / 2);
  return unit(cos, (sin / angle) * turn);
}

Vec3 Rotation::vector() const {
  const double sine = length(v);
  if (!(sine > 0)) return {};
  const double angle = 2 * angle_of(sine, std::abs(w));
  return (w < 0 ? -angle / sine : angle / sine) * v;
}

Rotation Rotation::after(const Rotation& first) const {
  return unit(w * first.w - dot(v, first.v), w * first.v + first.w * v + cross(v, first.v));
}

}  // namespace morula::detail
