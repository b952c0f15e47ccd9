// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <map>
#include <morula/geometry/reproducible.hpp>
#include <numbers>
#include <support/meshes.hpp>
#include <utility>

namespace morula::test {

Mesh icosphere(int subdivisions, double radius, const Vec3& center) {
  const double g = std::numbers::phi;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.facets = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertex_count()));
      // Onto the sphere at once: the next level's middles are then nearer to even.
      if (is_new) mesh.positions.push_back(normalized(mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<Facet> finer;
    finer.reserve(4 * mesh.facet_count());
    for (const auto& [a, b, c] : mesh.facets) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {Facet{a, ab, ca}, Facet{b, bc, ab}, Facet{c, ca, bc}, Facet{ab, bc, ca}});
    }
    mesh.facets = std::move(finer);
  }
  for (Vec3& p : mesh.positions) p = center + normalized(p) * radius;
  return mesh;
}

Mesh uv_sphere(int around, int rings, double radius, const Vec3& center) {
  Mesh mesh;
  mesh.positions.push_back(center + Vec3{0, 0, -radius});
  for (int ring = 1; ring < rings; ++ring) {
    const auto [s, c] = sin_cos(std::numbers::pi * ring / rings);
    for (int i = 0; i < around; ++i) {
      const auto [si, ci] = sin_cos(2 * std::numbers::pi * i / around);
      mesh.positions.push_back(center + Vec3{s * ci, s * si, -c} * radius);
    }
  }
  mesh.positions.push_back(center + Vec3{0, 0, radius});
  const auto at = [&](int ring, int i) { return static_cast<std::uint32_t>(1 + (ring - 1) * around + i % around); };
  const std::uint32_t last = static_cast<std::uint32_t>(mesh.vertex_count() - 1);
  for (int i = 0; i < around; ++i) {
    mesh.facets.push_back({0, at(1, i + 1), at(1, i)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      mesh.facets.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      mesh.facets.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
    mesh.facets.push_back({at(rings - 1, i), at(rings - 1, i + 1), last});
  }
  return mesh;
}

Mesh box_mesh(const Vec3& lower, const Vec3& upper, int n) {
  Mesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> indices;
  const auto vertex = [&](const std::array<int, 3>& cell) {
    const auto [entry, is_new] = indices.try_emplace(cell, static_cast<std::uint32_t>(mesh.vertex_count()));
    if (is_new) {
      Vec3 p;
      // The far side exactly at `upper`, whatever the rounding of the steps.
      for (int axis = 0; axis < 3; ++axis)
        p[axis] = cell[axis] == n ? upper[axis] : lower[axis] + (upper[axis] - lower[axis]) * cell[axis] / n;
      mesh.positions.push_back(p);
    }
    return entry->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> cell{};
            cell[axis] = side;
            cell[(axis + 1) % 3] = i + di;
            cell[(axis + 2) % 3] = j + dj;
            return vertex(cell);
          };
          const std::uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side == n)
            mesh.facets.insert(mesh.facets.end(), {Facet{a, b, c}, Facet{a, c, d}});
          else
            mesh.facets.insert(mesh.facets.end(), {Facet{a, c, b}, Facet{a, d, c}});
        }
  return mesh;
}

Mesh grid_plate(int n, double width, double depth) {
  Mesh mesh;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) mesh.positions.push_back({width * i / n, depth * j / n, 0});
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * (n + 1) + i), b = a + 1;
      const std::uint32_t d = a + static_cast<std::uint32_t>(n + 1), c = d + 1;
      mesh.facets.insert(mesh.facets.end(), {Facet{a, b, c}, Facet{a, c, d}});
    }
  return mesh;
}

Mesh facet_soup(std::size_t facet_count, std::uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (std::uint32_t f = 0; f < facet_count; ++f) {
    for (int corner = 0; corner < 3; ++corner) {
      const double x = random.uniform(), y = random.uniform(), z = random.uniform();
      mesh.positions.push_back({x, y, z});
    }
    mesh.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return mesh;
}

Mesh joined(const Mesh& a, const Mesh& b) {
  Mesh both = a;
  const auto shift = static_cast<std::uint32_t>(a.vertex_count());
  both.positions.insert(both.positions.end(), b.positions.begin(), b.positions.end());
  for (const Facet& f : b.facets) both.facets.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  return both;
}

Mesh soup_of(const Mesh& mesh) {
  Mesh soup;
  for (const Facet& f : mesh.facets) {
    const auto first = static_cast<std::uint32_t>(soup.positions.size());
    for (const std::uint32_t v : f) soup.positions.push_back(mesh.positions[v]);
    soup.facets.push_back({first, first + 1, first + 2});
  }
  return soup;
}

Mesh placed(Mesh mesh, const RigidTransform& place) {
  for (Vec3& p : mesh.positions) p = place(p);
  return mesh;
}

Mesh inverted(Mesh mesh) {
  for (Facet& f : mesh.facets) std::swap(f[1], f[2]);
  return mesh;
}

Mesh scaled(Mesh mesh, double factor) {
  for (Vec3& p : mesh.positions) p *= factor;
  return mesh;
}

Mesh translated(Mesh mesh, const Vec3& offset) {
  for (Vec3& p : mesh.positions) p += offset;
  return mesh;
}

}  // namespace morula::test
