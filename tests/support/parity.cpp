// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "support/parity.hpp"

namespace morula::test {

bool parity_inside(const Mesh& mesh, const Vec3& point) {
  const Vec3 direction = normalized(Vec3{0.571, 0.3117, 0.7613});
  bool inside = false;
  for (const Facet& facet : mesh.facets) {
    const Vec3 a = mesh.positions[facet[0]], ab = mesh.positions[facet[1]] - a, ac = mesh.positions[facet[2]] - a;
    const Vec3 h = cross(direction, ac);
    const double det = dot(ab, h);
    if (det == 0) continue;
    const Vec3 s = point - a;
    const double u = dot(s, h) / det, v = dot(direction, cross(s, ab)) / det, t = dot(ac, cross(s, ab)) / det;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0) inside = !inside;
  }
  return inside;
}

}  // namespace morula::test
