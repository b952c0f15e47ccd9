// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <morula/geometry/reproducible.hpp>
#include <numbers>
#include <stdexcept>
#include <support/meshes.hpp>

namespace morula::test {
namespace {

const Vec3 zero{0, 0, 0}, one{1, 1, 1};

Mesh cube(int n = 1) {
  return box_mesh(zero, one, n);
}

Mesh ellipsoid(int subdivisions, const Vec3& half_axes) {
  Mesh mesh = icosphere(subdivisions);
  for (Vec3& p : mesh.positions) p = {p.x * half_axes.x, p.y * half_axes.y, p.z * half_axes.z};
  return mesh;
}

// On every facet of a cube a new vertex, 1e-9 from the middle of an edge: the facet at that edge is a sliver.
Mesh cube_with_slivers() {
  Mesh mesh = cube();
  for (std::size_t f = 0, end = mesh.facet_count(); f < end; ++f) {
    const auto [a, b, c] = mesh.facets[f];
    const auto [pa, pb, pc] = mesh.corners(f);
    const auto p = static_cast<std::uint32_t>(mesh.vertex_count());
    mesh.positions.push_back((pa + pb) * 0.5 * (1 - 1e-9) + pc * 1e-9);
    mesh.facets[f] = {a, b, p};
    mesh.facets.insert(mesh.facets.end(), {Facet{b, c, p}, Facet{c, a, p}});
  }
  return mesh;
}

// One side of an edge is split at the middle, the other is not; a facet without area closes the slit.
Mesh cube_with_collinear_facet() {
  Mesh mesh = cube();
  const auto [a, b, c] = mesh.facets[0];
  const auto m = static_cast<std::uint32_t>(mesh.vertex_count());
  mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
  mesh.facets[0] = {a, m, c};
  mesh.facets.insert(mesh.facets.end(), {Facet{m, b, c}, Facet{a, b, m}});
  return mesh;
}

Mesh cube_with_repeated_indices() {
  Mesh mesh = cube();
  mesh.facets.insert(mesh.facets.end(), {Facet{0, 0, 1}, Facet{2, 3, 2}, Facet{4, 4, 4}});
  return mesh;
}

Mesh cube_with_duplicated_facet() {
  Mesh mesh = cube();
  const auto [a, b, c] = mesh.facets[0];
  mesh.facets.push_back({b, c, a});
  return mesh;
}

Mesh cube_with_unused_vertices() {
  Mesh mesh = cube();
  mesh.positions.insert(mesh.positions.begin(), Vec3{0.5, 0.5, 0.5});
  mesh.positions.push_back({1e9, -1e9, 3});
  for (Facet& f : mesh.facets) f = {f[0] + 1, f[1] + 1, f[2] + 1};
  return mesh;
}

// Every facet has its own corners, as an STL file has them: closed to the eye, open by its indices.
Mesh with_own_corners(const Mesh& shared) {
  Mesh mesh;
  for (std::size_t f = 0; f < shared.facet_count(); ++f) {
    for (const Vec3& p : shared.corners(f)) mesh.positions.push_back(p);
    const auto first = static_cast<std::uint32_t>(3 * f);
    mesh.facets.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Mesh moebius_strip(int around) {
  Mesh mesh;
  for (int i = 0; i < around; ++i) {
    const auto [s, c] = sin_cos(2 * std::numbers::pi * i / around);
    const auto [half_s, half_c] = sin_cos(std::numbers::pi * i / around);
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * half_c;
      mesh.positions.push_back({r * c, r * s, side * half_s});
    }
  }
  for (int i = 0; i < around; ++i) {
    const auto a = static_cast<std::uint32_t>(2 * i), b = a + 1;
    // Half a turn later the two rims have changed places.
    const bool last = i + 1 == around;
    const std::uint32_t c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    mesh.facets.insert(mesh.facets.end(), {Facet{a, c, b}, Facet{b, c, d}});
  }
  return mesh;
}

Mesh three_pages() {
  return {{{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {-0.5, 0.8, 0.5}, {-0.5, -0.8, 0.5}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}};
}

// Two closed four-sided cones, tip to tip in one vertex.
Mesh cones_at_one_vertex() {
  return {{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}, {-1, 0, 1}, {0, -1, 1}, {1, 0, -1}, {0, 1, -1}, {-1, 0, -1}, {0, -1, -1}},
          {{0, 2, 1},
           {0, 3, 2},
           {0, 4, 3},
           {0, 1, 4},
           {1, 2, 3},
           {1, 3, 4},
           {0, 5, 6},
           {0, 6, 7},
           {0, 7, 8},
           {0, 8, 5},
           {5, 7, 6},
           {5, 8, 7}}};
}

// Two cubes that share one edge, each by the same two vertices.
Mesh cubes_at_one_edge() {
  Mesh mesh = cube();
  const Mesh second = box_mesh({1, 1, 0}, {2, 2, 1});
  std::vector<std::uint32_t> index_of;
  for (const Vec3& p : second.positions) {
    const auto same = std::find(mesh.positions.begin(), mesh.positions.end(), p);
    index_of.push_back(static_cast<std::uint32_t>(same - mesh.positions.begin()));
    if (same == mesh.positions.end()) mesh.positions.push_back(p);
  }
  for (const Facet& f : second.facets) mesh.facets.push_back({index_of[f[0]], index_of[f[1]], index_of[f[2]]});
  return mesh;
}

Mesh open_scan() {
  Mesh mesh = icosphere(3);
  std::vector<Facet> kept;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto [a, b, c] = mesh.corners(f);
    if (a.z + b.z + c.z < 1.8) kept.push_back(mesh.facets[f]);
  }
  mesh.facets = std::move(kept);
  return mesh;
}

std::vector<NamedMesh> make_all() {
  std::vector<NamedMesh> all;
  const auto open = [&](std::string name, Mesh mesh, bool oriented, bool manifold) {
    all.push_back({std::move(name), std::move(mesh), false, oriented, manifold, 0.0});
  };
  const auto closed = [&](std::string name, Mesh mesh, bool manifold, double volume) {
    all.push_back({std::move(name), std::move(mesh), true, true, manifold, volume});
  };
  // Plain closed bodies.
  const Mesh ball = icosphere(3), round = uv_sphere(24, 12), egg = ellipsoid(2, {1, 0.7, 0.5});
  closed("cube_12", cube(), true, 1);
  closed("coplanar_box", box_mesh(zero, {3, 2, 1}, 6), true, 6);
  closed("icosphere", ball, true, signed_volume(ball));
  closed("uv_sphere", round, true, signed_volume(round));
  // Extreme shapes.
  const Mesh needle = ellipsoid(2, {1, 1e-3, 1e-3});
  closed("needle", needle, true, signed_volume(needle));
  closed("thin_box", box_mesh(zero, {1, 1, 1e-4}, 4), true, 1e-4);
  closed("sliver_facets", cube_with_slivers(), true, 1);
  closed("collinear_facet", cube_with_collinear_facet(), true, 1);
  closed("repeated_indices", cube_with_repeated_indices(), true, 1);
  closed("folded_facet", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}}, true, 0);
  // Extreme places and sizes.
  const double egg_volume = signed_volume(egg);
  closed("tiny", scaled(egg, 1e-6), true, egg_volume * 1e-18);
  closed("huge", scaled(egg, 1e6), true, egg_volume * 1e18);
  closed("far_away", translated(cube(3), {1e6, -1e6, 1e6}), true, 1);
  // Several parts, inside out, touching themselves.
  closed("two_components", joined(cube(2), translated(cube(), {3, 0.5, 0})), true, 2);
  closed("nested_shells", joined(box_mesh(zero, {4, 4, 4}, 2), inverted(box_mesh(one, {3, 3, 3}, 2))), true, 64 - 8);
  closed("inverted", inverted(cube(2)), true, -1);
  closed("cones_at_one_vertex", cones_at_one_vertex(), false, 4.0 / 3.0);
  closed("cubes_at_one_edge", cubes_at_one_edge(), false, 2);
  // Vertices that are no use.
  closed("unused_vertices", cube_with_unused_vertices(), true, 1);
  open("duplicate_vertices", with_own_corners(cube()), true, true);
  // Open or broken surfaces.
  open("single_facet", {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, true, true);
  open("flat_plate", grid_plate(10), true, true);
  open("open_scan", open_scan(), true, true);
  open("moebius_strip", moebius_strip(24), false, true);
  open("three_pages", three_pages(), true, false);
  open("duplicated_facet", cube_with_duplicated_facet(), true, false);
  open("facet_soup", facet_soup(60, 7), true, true);
  return all;
}

}  // namespace

const std::vector<NamedMesh>& all_meshes() {
  static const std::vector<NamedMesh> all = make_all();
  return all;
}

std::vector<NamedMesh> closed_meshes() {
  std::vector<NamedMesh> closed;
  for (const NamedMesh& named : all_meshes())
    if (named.has_volume() && named.volume > 0) closed.push_back(named);
  return closed;
}

const NamedMesh& mesh_named(const std::string& name) {
  for (const NamedMesh& named : all_meshes())
    if (named.name == name) return named;
  throw std::invalid_argument("no test mesh is called '" + name + "'");
}

}  // namespace morula::test
