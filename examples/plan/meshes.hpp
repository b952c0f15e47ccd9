// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Tests of triangles for the path that the planner found. They use neither spheres nor queries.
#pragma once

#include <algorithm>
#include <limits>
#include <morula/robot/configurations.hpp>
#include <morula/robot/robot.hpp>
#include <vector>

using Triangle = std::array<morula::Vec3, 3>;

struct Triangles {
  std::vector<Triangle> all;
  morula::Vec3 low{}, high{};  // their box
};

inline Triangles posed(const morula::Mesh& mesh, const morula::RigidTransform& at) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Triangles result{{}, {far, far, far}, {-far, -far, -far}};
  for (const auto& facet : mesh.facets) {
    Triangle& t = result.all.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const morula::Vec3 p = t[k] = at(mesh.positions[facet[k]]);
      result.low = {std::min(result.low.x, p.x), std::min(result.low.y, p.y), std::min(result.low.z, p.z)};
      result.high = {std::max(result.high.x, p.x), std::max(result.high.y, p.y), std::max(result.high.z, p.z)};
    }
  }
  return result;
}

/// Six times the signed volume of a tetrahedron.
inline double volume(const morula::Vec3& a, const morula::Vec3& b, const morula::Vec3& c, const morula::Vec3& d) {
  return dot(b - a, cross(c - a, d - a));
}

/// The segment p q crosses the triangle; one that only touches a corner or edge may count or not.
inline bool crosses(const morula::Vec3& p, const morula::Vec3& q, const Triangle& t) {
  if ((volume(t[0], t[1], t[2], p) > 0) == (volume(t[0], t[1], t[2], q) > 0)) return false;
  const bool side = volume(p, q, t[0], t[1]) > 0;
  return side == (volume(p, q, t[1], t[2]) > 0) && side == (volume(p, q, t[2], t[0]) > 0);
}

inline bool crosses(const Triangle& a, const Triangle& b) {
  for (std::size_t k = 0; k < 3; ++k)
    if (crosses(a[k], a[(k + 1) % 3], b) || crosses(b[k], b[(k + 1) % 3], a)) return true;
  return false;
}

/// A triangle of one crosses a triangle of the other.
inline bool cross_each_other(const Triangles& a, const Triangles& b) {
  const auto apart = [](const morula::Vec3& high, const morula::Vec3& low) {
    return high.x < low.x || high.y < low.y || high.z < low.z;
  };
  if (apart(a.high, b.low) || apart(b.high, a.low)) return false;
  for (const Triangle& t : a.all)
    for (const Triangle& u : b.all)
      if (crosses(t, u)) return true;
  return false;
}

/// A closed box with edges along the axes.
inline morula::Mesh box_mesh(const morula::Vec3& center, const morula::Vec3& half) {
  morula::Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(
        center + morula::Vec3{i & 1 ? half.x : -half.x, i & 2 ? half.y : -half.y, i & 4 ? half.z : -half.z});
  mesh.facets = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}
