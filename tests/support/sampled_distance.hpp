// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// How far a surface is from spheres, by samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <vector>

namespace morula::test {

/// The largest distance of points of the facets, taken at even barycentric steps, from the spheres, whose numbers are
/// read as floats if `floats` is true.
inline double sampled_distance(const Mesh& mesh, const std::vector<Sphere>& spheres, bool floats = false) {
  constexpr int steps = 6;
  double largest = 0;
  const auto read = [&](double value) { return floats ? static_cast<double>(static_cast<float>(value)) : value; };
  for (const Facet& f : mesh.facets) {
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; i + j <= steps; ++j) {
        const double a = static_cast<double>(i) / steps, b = static_cast<double>(j) / steps;
        const Vec3 p = mesh.positions[f[0]] * a + mesh.positions[f[1]] * b + mesh.positions[f[2]] * (1 - a - b);
        double least = std::numeric_limits<double>::infinity();
        for (const Sphere& s : spheres) {
          least = std::min(least, std::hypot(p.x - read(s.center.x), p.y - read(s.center.y), p.z - read(s.center.z)) -
                                      read(s.radius));
        }
        largest = std::max(largest, least);
      }
    }
  }
  return largest;
}

}  // namespace morula::test
