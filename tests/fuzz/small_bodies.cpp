// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "small_bodies.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace morula::fuzz {
namespace {

constexpr std::size_t most_vertices = 32, most_facets = 48;

enum Kind : std::size_t { lattice, scaled_lattice, far_lattice, floats, doubles, odd_numbers, kinds };

double odd_number(std::size_t i) {
  constexpr double largest = std::numeric_limits<double>::max(), smallest = std::numeric_limits<double>::min();
  constexpr std::array numbers{0.0,
                               -0.0,
                               1.0,
                               -1.0,
                               0.5,
                               1.0 + 0x1p-52,
                               1e-9,
                               1e9,
                               1e9 + 1,
                               1e-150,
                               1e-300,
                               1e150,
                               1e300,
                               smallest,
                               std::numeric_limits<double>::denorm_min(),
                               largest,
                               -largest,
                               1.0 / 3.0,
                               std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()};
  return numbers[i % numbers.size()];
}

double coordinate(Bytes& in, std::size_t kind, double scale, double offset) {
  switch (kind) {
    case floats:
      return static_cast<double>(in.float32());
    case doubles:
      return in.float64();
    case odd_numbers:
      return odd_number(in.byte());
    default:
      return offset + scale * (static_cast<double>(in.byte()) - 128.0) / 8.0;
  }
}

// Long double: squares of all but the largest doubles fit.
bool contains(const Sphere& s, const std::array<long double, 3>& p, long double slack) {
  const long double x = p[0] - s.center.x, y = p[1] - s.center.y, z = p[2] - s.center.z;
  return std::sqrt(x * x + y * y + z * z) <= s.radius + slack;
}

}  // namespace

Mesh mesh_of(Bytes& in) {
  const std::size_t kind = in.below(kinds);
  const int exponent = kind == scaled_lattice ? static_cast<int>(in.byte()) - 128 : 0;
  const double scale = std::ldexp(1.0, 8 * exponent);
  const double offset = kind == far_lattice ? std::ldexp(1.0, static_cast<int>(in.below(64))) : 0.0;
  Mesh mesh;
  mesh.positions.resize(in.below(most_vertices + 1));
  mesh.facets.resize(in.below(most_facets + 1));
  for (Vec3& p : mesh.positions)
    for (int axis = 0; axis < 3; ++axis) p[axis] = coordinate(in, kind, scale, offset);
  const std::size_t vertices = std::max<std::size_t>(1, mesh.vertex_count());
  for (Facet& f : mesh.facets)
    for (std::uint32_t& v : f) {
      const std::uint8_t index = in.byte();
      v = index == 255 ? 0xffffffffu : static_cast<std::uint32_t>(index % vertices);
    }
  return mesh;
}

bool is_extreme(const std::vector<Vec3>& positions) {
  for (const Vec3& p : positions)
    for (int axis = 0; axis < 3; ++axis) {
      const double size = std::abs(p[axis]);
      if (size > 0x1p100 || (size > 0 && size < 0x1p-100)) return true;
    }
  return false;
}

std::string bytes_of(const Mesh& mesh) {
  std::string bytes;
  const auto add = [&](std::size_t value) { bytes += static_cast<char>(static_cast<unsigned char>(value)); };
  add(lattice);
  const std::size_t vertices = std::min(mesh.vertex_count(), most_vertices);
  const std::size_t facets = std::min(mesh.facet_count(), most_facets);
  add(vertices);
  add(facets);
  for (std::size_t v = 0; v < vertices; ++v)
    for (int axis = 0; axis < 3; ++axis)
      add(static_cast<std::size_t>(std::clamp(std::lround(8 * mesh.positions[v][axis]) + 128, 0L, 255L)));
  for (std::size_t f = 0; f < facets; ++f)
    for (const std::uint32_t v : mesh.facets[f]) add(v);
  return bytes;
}

void require_cover(const Mesh& mesh, const std::vector<Vec3>& positions, const SphereTree& tree,
                   std::span<const Sphere> spheres) {
  long double largest = 0;
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f)
      for (int axis = 0; axis < 3; ++axis)
        largest = std::max(largest, static_cast<long double>(std::abs(positions[v][axis])));
  // Of the points below, not of the spheres: a cut point is rounded to double, and facets bend by as much.
  const long double slack = 16 * largest * 0x1p-52L;
  constexpr int steps = 4;
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    const std::vector<Sphere> set = level_set_spheres(tree, spheres, level);
    std::size_t last = 0;  // the next point is near the one before
    for (const Facet& f : mesh.facets)
      for (int i = 0; i <= steps; ++i)
        for (int j = 0; i + j <= steps; ++j) {
          std::array<long double, 3> p{};
          const std::array<int, 3> weights{i, j, steps - i - j};
          for (std::size_t k = 0; k < 3; ++k)
            for (int axis = 0; axis < 3; ++axis)
              p[static_cast<std::size_t>(axis)] +=
                  static_cast<long double>(positions[f[k]][axis]) * static_cast<long double>(weights[k]) / steps;
          if (contains(set[last], p, slack)) continue;
          for (last = 0; last < set.size() && !contains(set[last], p, slack); ++last) {
          }
          if (last == set.size()) found("a point of the surface is in no sphere of level " + std::to_string(level));
        }
  }
}

}  // namespace morula::fuzz
