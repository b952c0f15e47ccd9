// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "judge.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace morula::characters {
namespace {

using Real = long double;
using Point = std::array<Real, 3>;

std::vector<Point> posed(const Mesh& mesh, const Skin& skin, std::span<const AffineTransform> transforms) {
  std::vector<Point> points(mesh.vertex_count());
  for (std::size_t v = 0; v < points.size(); ++v) {
    const Vec3& rest = mesh.positions[v];
    for (int axis = 0; axis < 3; ++axis) {
      Real sum = rest[axis];
      for (std::uint32_t k = skin.begin[v]; k < skin.begin[v + 1]; ++k) {
        const AffineTransform& t = transforms[skin.bones[k]];
        Real moved = t.translation[axis];
        for (int column = 0; column < 3; ++column)
          moved += Real{t.columns[static_cast<std::size_t>(column)][axis]} * rest[column];
        sum += Real{skin.weights[k]} * (moved - rest[axis]);
      }
      points[v][static_cast<std::size_t>(axis)] = sum;
    }
  }
  return points;
}

}  // namespace

double largest_excess(const Body& body, const Mesh& mesh, const Skin& skin,
                      std::span<const AffineTransform> transforms) {
  std::vector<Point> corners = posed(mesh, skin, transforms);
  const Cover& cover = body.cover();
  for (const CutPoint& cut : cover.cut_points) {
    Point point{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t axis = 0; axis < 3; ++axis) point[axis] += Real{cut.weight[k]} * corners[cut.vertex[k]][axis];
    corners.push_back(point);
  }
  const Vec3 origin = body.origin();
  Real worst = -std::numeric_limits<Real>::infinity();
  for (std::uint32_t node = 0; node < body.rest_tree().node_count(); ++node) {
    const Spheref& sphere = body.spheres()[node];
    for (const std::uint32_t corner : cover.region_corners(node)) {
      Real squared = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const Real difference =
            corners[corner][static_cast<std::size_t>(axis)] - (Real{origin[axis]} + Real{sphere.center[axis]});
        squared += difference * difference;
      }
      const Real excess = std::sqrt(squared) - Real{sphere.radius};
      if (!(excess <= worst)) worst = excess;
    }
  }
  const auto narrow = static_cast<double>(worst);
  return Real{narrow} < worst ? std::nextafter(narrow, HUGE_VAL) : narrow;
}

}  // namespace morula::characters
