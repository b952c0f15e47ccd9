// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "bodies_at_scale.hpp"

#include <array>
#include <cmath>
#include <morula/geometry/sample_bodies.hpp>
#include <sstream>
#include <support/meshes.hpp>

namespace morula::test {
namespace {

Mesh octahedron() {
  Mesh mesh;
  mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.facets = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  return mesh;
}

}  // namespace

const std::vector<BodyAtScale>& unit_bodies() {
  static const std::vector<BodyAtScale> bodies{{"cube", box_mesh({-1, -1, -1}, {1, 1, 1}, 2)},
                                               {"octahedron", octahedron()},
                                               {"ball", icosphere(1)},
                                               {"plate", sample_body("plate", 4)},
                                               {"capsule", sample_body("capsule", 4)}};
  return bodies;
}

std::span<const double> sizes() {
  static constexpr std::array<double, 15> all{1e-300, 1e-200, 1e-160, 1e-150, 1e-100, 1e-50, 1e-20, 1,
                                              1e20,   1e50,   1e100,  1e150,  1e160,  1e200, 1e300};
  return all;
}

std::span<const double> offsets() {
  static constexpr std::array<double, 3> all{0, 1, 1e3};
  return all;
}

Vec3 placed(const Vec3& x, double size, double offset) {
  return (x + Vec3{offset, -offset, 0.5 * offset}) * size;
}

Mesh placed(Mesh mesh, double size, double offset) {
  for (Vec3& p : mesh.positions) p = placed(p, size, offset);
  return mesh;
}

std::string told(const std::string& name, double size, double offset) {
  std::ostringstream text;
  text << name << " of size " << size << " at " << offset << " sizes";
  return text.str();
}

double reach_of(const Mesh& mesh) {
  double largest = 0;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) largest = std::max(largest, max_norm(mesh.positions[v]));
  return largest;
}

bool is_out_of_range(const Mesh& mesh) {
  return reach_of(mesh) < 0x1p-100 || reach_of(mesh) > 0x1p100;
}

long double exact_distance(const Vec3& c, const std::array<long double, 3>& x) {
  long double squared = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const long double d = x[static_cast<std::size_t>(axis)] - static_cast<long double>(c[axis]);
    squared += d * d;
  }
  return std::sqrt(squared);
}

std::array<long double, 3> exact_corner(const Cover& cover, std::uint32_t corner, std::span<const Vec3> positions) {
  std::array<long double, 3> point{};
  const auto add = [&](std::uint32_t vertex, double weight) {
    for (int axis = 0; axis < 3; ++axis)
      point[static_cast<std::size_t>(axis)] +=
          static_cast<long double>(weight) * static_cast<long double>(positions[vertex][axis]);
  };
  if (corner < cover.vertex_count) {
    add(corner, 1);
  } else {
    const CutPoint& c = cover.cut_points[corner - cover.vertex_count];
    for (std::size_t k = 0; k < 3; ++k) add(c.vertex[k], c.weight[k]);
  }
  return point;
}

long double reach_from(const Vec3& center, const Cover& cover, std::uint32_t node, std::span<const Vec3> positions) {
  long double farthest = 0;
  for (const std::uint32_t c : cover.region_corners(node))
    farthest = std::max(farthest, exact_distance(center, exact_corner(cover, c, positions)));
  return farthest;
}

bool covers(const Cover& cover, std::span<const Vec3> positions, std::span<const Sphere> spheres) {
  for (std::uint32_t node = 0; node < spheres.size(); ++node) {
    const Sphere& s = spheres[node];
    if (!is_finite(s.center) || !std::isfinite(s.radius)) return false;
    if (!(reach_from(s.center, cover, node, positions) <= static_cast<long double>(s.radius))) return false;
  }
  return true;
}

}  // namespace morula::test
