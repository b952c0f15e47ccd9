// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shapes.hpp"

#include <array>
#include <limits>
#include <map>
#include <morula/geometry/sample_bodies.hpp>
#include <numbers>
#include <stdexcept>
#include <support/meshes.hpp>

#include "spoil.hpp"

namespace morula::properties {
namespace {

using Index = std::uint32_t;

double lattice(double x, double step = 0x1p-6) {
  return std::round(x / step) * step;
}

// Sides of a whole number of squares: cuts at halves and quarters meet vertices.
Mesh box(Dice& dice, std::size_t most) {
  int n = 1;
  while (n < 4 && 12 * static_cast<std::size_t>((n + 1) * (n + 1)) <= most && dice.chance(0.6)) ++n;
  const Vec3 size = dice.pick<Vec3>({{1, 1, 1}, {2, 2, 2}, {4, 2, 1}, {1, 1, 0.125}, {3, 1, 1}, {8, 1, 1}});
  const Vec3 lower = dice.chance(0.5) ? Vec3{0, 0, 0} : size * -0.5;
  return test::box_mesh(lower, lower + size, n);
}

// Each facet into four, flat: all new vertices are on the facets.
void subdivide(Mesh& mesh) {
  std::map<std::pair<Index, Index>, Index> middles;
  const auto middle = [&](Index a, Index b) {
    const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.vertex_count()));
    if (is_new) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
    return entry->second;
  };
  std::vector<Facet> finer;
  for (const auto& [a, b, c] : mesh.facets) {
    const Index ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {Facet{a, ab, ca}, Facet{b, bc, ab}, Facet{c, ca, bc}, Facet{ab, bc, ca}});
  }
  mesh.facets = std::move(finer);
}

Mesh octahedron(Dice& dice, std::size_t most) {
  Mesh mesh{{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
            {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
  while (4 * mesh.facet_count() <= most && dice.chance(0.5)) subdivide(mesh);
  if (dice.chance(0.3))
    for (Vec3& p : mesh.positions) p = normalized(p);
  return mesh;
}

Mesh tetrahedron(Dice& dice, std::size_t most) {
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};
  if (dice.chance(0.5)) mesh.positions = {{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}};
  while (4 * mesh.facet_count() <= most && dice.chance(0.5)) subdivide(mesh);
  return mesh;
}

// Rings of vertices about x, joined; poles at both ends close it.
Mesh turned(int around, int rings, const auto& radius, const auto& height, bool closed) {
  Mesh mesh;
  for (int j = 0; j < rings; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * std::numbers::pi * i / around;
      mesh.positions.push_back({height(j), radius(j) * std::cos(angle), radius(j) * std::sin(angle)});
    }
  const auto at = [&](int j, int i) { return static_cast<Index>(j * around + i % around); };
  for (int j = 0; j + 1 < rings; ++j)
    for (int i = 0; i < around; ++i) {
      mesh.facets.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1)});
      mesh.facets.push_back({at(j, i), at(j + 1, i + 1), at(j + 1, i)});
    }
  if (!closed) return mesh;
  const auto pole = static_cast<Index>(mesh.vertex_count());
  mesh.positions.push_back({height(0), 0, 0});
  mesh.positions.push_back({height(rings - 1), 0, 0});
  for (int i = 0; i < around; ++i) {
    mesh.facets.push_back({at(0, i + 1), at(0, i), pole});
    mesh.facets.push_back({at(rings - 1, i), at(rings - 1, i + 1), pole + 1});
  }
  return mesh;
}

Mesh prism(Dice& dice, std::size_t most) {
  const int around = dice.between(3, std::clamp(static_cast<int>(most / 4), 3, 16));
  const double length = dice.pick({0.25, 1.0, 2.0, 4.0, 16.0});
  const bool snapped = dice.chance(0.6);
  Mesh mesh = turned(
      around, 2, [](int) { return 1.0; }, [&](int j) { return j * length; }, true);
  if (snapped)
    for (Vec3& p : mesh.positions) p = {lattice(p.x), lattice(p.y), lattice(p.z)};
  return mesh;
}

Mesh cylinder(Dice& dice, std::size_t most) {
  const int around = dice.between(3, std::clamp(static_cast<int>(most / 6), 3, 16));
  const int rings = dice.between(2, std::clamp(static_cast<int>(most) / (2 * around), 2, 8));
  const bool open = dice.chance(0.3), cone = dice.chance(0.2);
  Mesh mesh = turned(
      around, rings, [&](int j) { return cone ? 1.0 - 0.125 * j : 1.0; }, [](int j) { return 0.5 * j; }, !open);
  if (dice.chance(0.6))
    for (Vec3& p : mesh.positions) p = {lattice(p.x), lattice(p.y), lattice(p.z)};
  return mesh;
}

Mesh ring(Dice& dice, std::size_t most) {
  const int around = dice.between(3, std::clamp(static_cast<int>(std::sqrt(static_cast<double>(most) / 2)), 3, 12));
  const int along = dice.between(3, std::clamp(static_cast<int>(most) / (2 * around), 3, 16));
  Mesh mesh;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double a = 2 * std::numbers::pi * j / along, b = 2 * std::numbers::pi * i / around;
      mesh.positions.push_back(
          {(1 + 0.375 * std::cos(b)) * std::cos(a), (1 + 0.375 * std::cos(b)) * std::sin(a), 0.375 * std::sin(b)});
    }
  const auto at = [&](int j, int i) { return static_cast<Index>(j % along * around + i % around); };
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      mesh.facets.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      mesh.facets.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
  if (dice.chance(0.5))
    for (Vec3& p : mesh.positions) p = {lattice(p.x), lattice(p.y), lattice(p.z)};
  return mesh;
}

Mesh sample(Dice& dice, std::size_t most) {
  const auto names = sample_body_names();
  const std::string_view name = names[dice.below(names.size())];
  Mesh mesh = sample_body(name, dice.between(3, 16));
  for (int resolution = 15; mesh.facet_count() > most && resolution >= 3; --resolution)
    mesh = sample_body(name, resolution);
  return mesh;
}

Mesh plate(Dice& dice, std::size_t most) {
  const int n = dice.between(1, std::clamp(static_cast<int>(std::sqrt(static_cast<double>(most) / 2)), 1, 12));
  const double width = dice.pick({1.0, 2.0, 3.0, 8.0}), depth = dice.pick({1.0, 2.0, 0.0625});
  return test::grid_plate(n, width, depth);
}

// Heights are whole numbers.
Mesh hills(Dice& dice, std::size_t most) {
  Mesh mesh = plate(dice, most);
  for (Vec3& p : mesh.positions) p.z = 0.25 * static_cast<double>(dice.below(4));
  return mesh;
}

Mesh ball(Dice& dice, std::size_t most) {
  if (dice.chance(0.5)) return test::icosphere(most >= 320 && dice.chance(0.3) ? 2 : most >= 80 ? 1 : 0);
  const int around = dice.between(3, 12);
  return test::uv_sphere(around, std::clamp(static_cast<int>(most) / (2 * around) + 1, 2, 9));
}

Mesh soup(Dice& dice, std::size_t most) {
  const std::size_t count = 1 + dice.below(most);
  return test::facet_soup(count, dice.next());
}

Mesh lattice_soup(Dice& dice, std::size_t most) {
  Mesh mesh;
  const std::size_t side = dice.pick<std::size_t>({2, 3, 5, 9});
  const std::size_t vertices = 3 + dice.below(most);
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto at = [&] { return static_cast<double>(dice.below(side)); };
    mesh.positions.push_back({at(), at(), at()});
  }
  for (std::size_t f = 1 + dice.below(most); f > 0; --f) {
    const auto any = [&] { return static_cast<Index>(dice.below(vertices)); };
    mesh.facets.push_back({any(), any(), any()});
  }
  return mesh;
}

// Many facets on one edge.
Mesh pages(Dice& dice, std::size_t most) {
  Mesh mesh{{{0, 0, 0}, {0, 0, 1}}, {}};
  const std::size_t count = 2 + dice.below(std::min<std::size_t>(most, 24));
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    mesh.positions.push_back({std::cos(angle), std::sin(angle), dice.pick({0.0, 0.5, 2.0})});
    mesh.facets.push_back({0, 1, static_cast<Index>(i + 2)});
  }
  return mesh;
}

Mesh strip(Dice& dice, std::size_t most) {
  Mesh mesh;
  const std::size_t count = 1 + dice.below(std::min<std::size_t>(most / 2 + 1, 40));
  const double width = dice.pick({1.0, 0x1p-4, 1e-6});
  const bool half_turn = count >= 5 && dice.chance(0.4);
  for (std::size_t i = 0; i <= count; ++i)
    for (const double side : {-1.0, 1.0}) mesh.positions.push_back({static_cast<double>(i), side * width, 0});
  for (std::size_t i = 0; i < count; ++i) {
    const auto a = static_cast<Index>(2 * i);
    mesh.facets.push_back({a, a + 2, a + 1});
    mesh.facets.push_back({a + 1, a + 2, a + 3});
  }
  if (half_turn) {
    const auto last = static_cast<Index>(2 * count);
    mesh.facets.push_back({last, 1, last + 1});
    mesh.facets.push_back({last + 1, 1, 0});
  }
  return mesh;
}

Mesh slivers(Dice& dice, std::size_t most) {
  Mesh mesh = test::box_mesh({0, 0, 0}, {1, 1, 1});
  const double thin = dice.pick({1e-3, 1e-6, 1e-9, 1e-12, 0x1p-50});
  for (std::size_t f = 0, end = mesh.facet_count(); f < end && mesh.facet_count() + 2 <= most; ++f) {
    const auto [a, b, c] = mesh.facets[f];
    const auto [pa, pb, pc] = mesh.corners(f);
    const auto p = static_cast<Index>(mesh.vertex_count());
    mesh.positions.push_back((pa + pb) * 0.5 * (1 - thin) + pc * thin);
    mesh.facets[f] = {a, b, p};
    mesh.facets.insert(mesh.facets.end(), {Facet{b, c, p}, Facet{c, a, p}});
  }
  return mesh;
}

// Nothing but segments and points, named so by their indices or only by their positions.
Mesh threads(Dice& dice, std::size_t most) {
  Mesh mesh;
  const std::size_t vertices = 1 + dice.below(20);
  for (std::size_t i = 0; i < vertices; ++i)
    mesh.positions.push_back({static_cast<double>(dice.below(5)), static_cast<double>(dice.below(3)), 0});
  for (std::size_t f = 1 + dice.below(std::min<std::size_t>(most, 40)); f > 0; --f) {
    const auto any = [&] { return static_cast<Index>(dice.below(vertices)); };
    const Index a = any(), b = any();
    mesh.facets.push_back(dice.pick<Facet>({{a, b, b}, {a, a, b}, {a, b, a}, {a, a, a}}));
  }
  return mesh;
}

// The outside of some cells of a lattice: edges and corners of more than two facets.
Mesh voxels(Dice& dice, std::size_t most) {
  Mesh mesh;
  std::map<std::array<int, 3>, Index> number;
  const int side = most >= 100 ? 3 : 2;
  std::vector<bool> full(static_cast<std::size_t>(side * side * side));
  const double density = dice.uniform(0.2, 0.9);
  for (std::size_t i = 0; i < full.size(); ++i) full[i] = dice.chance(density);
  full[dice.below(full.size())] = true;
  const auto is_full = [&](const std::array<int, 3>& c) {
    for (const int x : c)
      if (x < 0 || x >= side) return false;
    return static_cast<bool>(full[static_cast<std::size_t>((c[0] * side + c[1]) * side + c[2])]);
  };
  for (int cell = 0; cell < side * side * side; ++cell) {
    const std::array<int, 3> c{cell / side / side, cell / side % side, cell % side};
    if (!is_full(c)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int way : {0, 1}) {
        std::array<int, 3> beside = c;
        beside[axis] += 2 * way - 1;
        if (is_full(beside)) continue;
        std::array<Index, 4> corner{};
        for (std::size_t k = 0; k < 4; ++k) {
          std::array<int, 3> p = c;
          p[axis] += way;
          p[(axis + 1) % 3] += k == 1 || k == 2;
          p[(axis + 2) % 3] += k >= 2;
          const auto [entry, is_new] = number.try_emplace(p, static_cast<Index>(mesh.vertex_count()));
          if (is_new) mesh.positions.push_back({double(p[0]), double(p[1]), double(p[2])});
          corner[k] = entry->second;
        }
        if (way == 0) std::swap(corner[1], corner[3]);
        mesh.facets.push_back({corner[0], corner[1], corner[2]});
        mesh.facets.push_back({corner[0], corner[2], corner[3]});
      }
  }
  return mesh;
}

Mesh few(Dice& dice, std::size_t) {
  const std::size_t count = 1 + dice.below(3);
  Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}}, {{0, 1, 2}, {0, 2, 1}, {1, 4, 2}}};
  mesh.facets.resize(count);
  return mesh;
}

Mesh nested(Dice& dice, std::size_t most) {
  const Mesh outer = box(dice, most / 2);
  Mesh inner = outer;
  const Vec3 middle = bounding_box(outer).center();
  const double scale = dice.pick({0.5, 0.75, 0x1p-10, 1.0});
  for (Vec3& p : inner.positions) p = middle + (p - middle) * scale;
  return test::joined(outer, dice.chance(0.7) ? test::inverted(inner) : inner);
}

struct Family {
  std::string_view name;
  Mesh (*make)(Dice&, std::size_t);
};
constexpr Family all[]{
    {"box", box},
    {"octahedron", octahedron},
    {"tetrahedron", tetrahedron},
    {"prism", prism},
    {"cylinder", cylinder},
    {"ring", ring},
    {"sample", sample},
    {"plate", plate},
    {"hills", hills},
    {"ball", ball},
    {"soup", soup},
    {"lattice_soup", lattice_soup},
    {"pages", pages},
    {"strip", strip},
    {"slivers", slivers},
    {"threads", threads},
    {"voxels", voxels},
    {"few", few},
    {"nested", nested},
};
constexpr auto all_names = [] {
  std::array<std::string_view, std::size(all)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = all[i].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> families() {
  return all_names;
}

Mesh member(std::string_view family, Dice& dice, std::size_t most_facets) {
  for (const Family& f : all)
    if (f.name == family) return f.make(dice, most_facets);
  throw std::invalid_argument("no family is called '" + std::string(family) + "'");
}

Shape random_shape(Dice& dice, std::size_t most_facets) {
  const std::string_view family = all_names[dice.below(all_names.size())];
  Shape shape{std::string(family), member(family, dice, most_facets)};
  shape.name += " of " + std::to_string(shape.mesh.facet_count()) + " facets";
  const int changes = dice.pick({0, 0, 1, 1, 1, 2, 2, 3});
  for (int i = 0; i < changes; ++i) shape.name += ", " + std::string(spoil(shape.mesh, dice, 2 * most_facets + 4));
  return shape;
}

std::vector<bool> used_vertices(const Mesh& mesh) {
  std::vector<bool> used(mesh.vertex_count());
  for (const Facet& f : mesh.facets)
    for (const Index v : f) used[v] = true;
  return used;
}

}  // namespace morula::properties
