// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Points to ask about a mesh: everywhere around it, and where answers are hardest.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/triangle.hpp>
#include <vector>

namespace morula::test {

inline Vec3 random_direction(Random& random) {
  for (;;) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
    const double squared = x * x + y * y + z * z;
    if (squared > 1e-4 && squared <= 1) return Vec3{x, y, z} / std::sqrt(squared);
  }
}

/// A point in the mesh's box, grown on every side by `margin` diagonals.
inline Vec3 point_around(const Box& box, double margin, Random& random) {
  const double grow = margin * box.diagonal();
  const double x = random.uniform(box.lower.x - grow, box.upper.x + grow);
  const double y = random.uniform(box.lower.y - grow, box.upper.y + grow);
  const double z = random.uniform(box.lower.z - grow, box.upper.z + grow);
  return {x, y, z};
}

/// On corners, edges and inside facets, exactly or as exactly as can be computed.
inline Vec3 point_on_surface(const Mesh& mesh, Random& random) {
  const Triangle t = mesh.corners(random.next() % mesh.facet_count());
  switch (random.next() % 4) {
    case 0:
      return t[random.next() % 3];
    case 1:
      return (t[0] + t[1]) * 0.5;
    case 2:
      return at_barycentric(t, {1.0 / 3, 1.0 / 3, 1.0 / 3});
    default: {
      const double u = random.uniform(), v = random.uniform() * (1 - u);
      return at_barycentric(t, {1 - u - v, u, v});
    }
  }
}

/// A third around the mesh, a third on its surface, a third beside the surface by 1e-1 … 1e-12 diagonals; some far
/// away.
inline std::vector<Vec3> hard_points(const Mesh& mesh, std::size_t count, std::uint64_t seed) {
  Random random(seed);
  const Box box = bounding_box(mesh);
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) switch (i % 3) {
      case 0:
        points.push_back(point_around(box, i % 30 == 0 ? 1e4 : 0.5, random));
        break;
      case 1:
        points.push_back(point_on_surface(mesh, random));
        break;
      default: {
        const Vec3 on = point_on_surface(mesh, random);
        const double off = box.diagonal() * std::pow(10.0, -random.uniform(1, 12));
        points.push_back(on + random_direction(random) * off);
      }
    }
  return points;
}

}  // namespace morula::test
