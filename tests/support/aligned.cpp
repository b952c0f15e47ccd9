// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/geometry/inspect.hpp>
#include <morula/geometry/sample_bodies.hpp>
#include <string>
#include <support/aligned.hpp>

namespace morula::test {
namespace {

Mesh octahedron() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

// Every facet into four, at the middles of its edges; the middles of lattice points are lattice points.
Mesh quartered(const Mesh& mesh) {
  Mesh finer = mesh;
  finer.facets.clear();
  for (const Facet& f : mesh.facets) {
    const auto first = static_cast<std::uint32_t>(finer.vertex_count());
    for (int k = 0; k < 3; ++k)
      finer.positions.push_back((mesh.positions[f[k]] + mesh.positions[f[(k + 1) % 3]]) * 0.5);
    const std::uint32_t ab = first, bc = first + 1, ca = first + 2;
    finer.facets.insert(finer.facets.end(), {{f[0], ab, ca}, {f[1], bc, ab}, {f[2], ca, bc}, {ab, bc, ca}});
  }
  return finer;
}

// A prism over a square that stands on its corner, n layers.
Mesh prism(int layers) {
  Mesh mesh;
  for (int i = 0; i <= layers; ++i)
    for (const Vec3& corner : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{-1, 0, 0}, Vec3{0, -1, 0}})
      mesh.positions.push_back(corner + Vec3{0, 0, 0.5 * i});
  const auto at = [](int layer, int k) { return static_cast<std::uint32_t>(4 * layer + k % 4); };
  for (int i = 0; i < layers; ++i)
    for (int k = 0; k < 4; ++k)
      mesh.facets.insert(mesh.facets.end(),
                         {{at(i, k), at(i, k + 1), at(i + 1, k + 1)}, {at(i, k), at(i + 1, k + 1), at(i + 1, k)}});
  for (const int i : {0, layers})
    mesh.facets.insert(mesh.facets.end(), {{at(i, 0), at(i, i == 0 ? 2 : 1), at(i, i == 0 ? 1 : 2)},
                                           {at(i, 0), at(i, i == 0 ? 3 : 2), at(i, i == 0 ? 2 : 3)}});
  return mesh;
}

}  // namespace

const std::vector<NamedMesh>& aligned_bodies() {
  static const std::vector<NamedMesh> bodies = [] {
    std::vector<NamedMesh> all;
    const auto add = [&](std::string name, Mesh mesh) {
      const MeshReport report = inspect(mesh);
      all.push_back({std::move(name), std::move(mesh), report.closed, report.oriented, report.manifold, 0});
    };
    add("octahedron", octahedron());
    add("octahedron, quartered", quartered(octahedron()));
    for (const int n : {1, 2, 5}) add("cube " + std::to_string(n), box_mesh({0, 0, 0}, {1, 1, 1}, n));
    add("cube on its origin", box_mesh({-1, -1, -1}, {1, 1, 1}, 3));
    add("box 4 x 2 x 1", box_mesh({0, 0, 0}, {4, 2, 1}, 2));
    add("prism", prism(4));
    add("plate", grid_plate(4));
    add("plate, two-sided", joined(grid_plate(3), inverted(grid_plate(3))));
    add("cube, facets doubled", joined(box_mesh({0, 0, 0}, {1, 1, 1}), box_mesh({0, 0, 0}, {1, 1, 1})));
    add("cube inside out", inverted(box_mesh({0, 0, 0}, {1, 1, 1}, 2)));
    add("one facet", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
    Mesh thin = box_mesh({0, 0, 0}, {1, 1, 1}, 2);
    thin.facets.insert(thin.facets.end(), {{0, 0, 0}, {0, 1, 1}, {1, 0, 1}, {2, 3, 2}});
    add("cube with segments and points as facets", std::move(thin));
    for (const char* name : {"bar", "capsule", "torus", "plate", "two", "limb"})
      for (const int resolution : {3, 4, 8})
        if (resolution < 8 || std::string(name) != "limb")
          add(std::string(name) + " " + std::to_string(resolution), sample_body(name, resolution));
    return all;
  }();
  return bodies;
}

}  // namespace morula::test
