// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "fit/within.hpp"

#include <algorithm>
#include <morula/query/signed_distance.hpp>

#include "fit/rounding.hpp"

namespace morula::robot {

void grow_inside(const Mesh& mesh, std::vector<Sphere>& spheres, double most_radius) {
  if (mesh.facets.empty()) return;
  const SignedDistance object(mesh);
  // mutant robot-growth-open: `!object.has_volume()` -> `false`
  if (!object.has_volume()) return;
  double extent = extent_of(spheres);
  for (const Vec3& p : mesh.positions) extent = std::max(extent, max_norm(p));
  // mutant robot-growth-rounding: `1e-6` -> `0`
  const double rounding = 1e-6 * extent;
  for (Sphere& s : spheres) {
    const double depth = -object(s.center);
    const bool wound = object.orientation() * object.bvh().winding_number(s.center) > 0.5;
    if (wound && depth > 0) s.radius = std::max(s.radius, std::min(depth - rounding, most_radius));
  }
}

}  // namespace morula::robot
