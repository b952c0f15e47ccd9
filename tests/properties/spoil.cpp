// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "spoil.hpp"

#include <limits>
#include <morula/geometry/rigid_transform.hpp>
#include <support/meshes.hpp>

#include "motions.hpp"
#include "shapes.hpp"

namespace morula::properties {
namespace {

using Index = std::uint32_t;

Index any_vertex(const Mesh& mesh, Dice& dice) {
  return mesh.facets[dice.below(mesh.facet_count())][dice.below(3)];
}

// Into four or three, the neighbors left as they are: their edges have vertices in the middle.
void subdivide_some(Mesh& mesh, Dice& dice, std::size_t most) {
  for (std::size_t i = 1 + dice.below(6); i > 0 && mesh.facet_count() + 3 <= most; --i) {
    const std::size_t f = dice.below(mesh.facet_count());
    const auto [a, b, c] = mesh.facets[f];
    const auto [p, q, r] = mesh.corners(f);
    const auto v = static_cast<Index>(mesh.vertex_count());
    if (dice.chance(0.4)) {
      mesh.positions.push_back((p + q + r) / 3.0);
      mesh.facets[f] = {a, b, v};
      mesh.facets.insert(mesh.facets.end(), {Facet{b, c, v}, Facet{c, a, v}});
    } else {
      mesh.positions.insert(mesh.positions.end(), {(p + q) * 0.5, (q + r) * 0.5, (r + p) * 0.5});
      mesh.facets[f] = {v, v + 1, v + 2};
      mesh.facets.insert(mesh.facets.end(), {Facet{a, v, v + 2}, Facet{b, v + 1, v}, Facet{c, v + 2, v + 1}});
    }
  }
}

void duplicate_some(Mesh& mesh, Dice& dice, std::size_t most) {
  const bool all = dice.chance(0.3);
  for (std::size_t i = all ? mesh.facet_count() : 1 + dice.below(4); i > 0 && mesh.facet_count() < most; --i) {
    const auto [a, b, c] = mesh.facets[all ? i - 1 : dice.below(mesh.facet_count())];
    mesh.facets.push_back(dice.pick<Facet>({{a, b, c}, {b, c, a}, {c, b, a}}));
  }
}

void two_sided(Mesh& mesh, std::size_t most) {
  for (std::size_t i = mesh.facet_count(); i > 0 && mesh.facet_count() < most; --i) {
    const auto [a, b, c] = mesh.facets[i - 1];
    mesh.facets.push_back({a, c, b});
  }
}

// Segments and points: by a repeated vertex, by equal positions, by corners on one line.
void add_facets_without_area(Mesh& mesh, Dice& dice) {
  for (int i = dice.between(1, 4); i > 0; --i) {
    const Index a = any_vertex(mesh, dice), b = any_vertex(mesh, dice);
    const auto v = static_cast<Index>(mesh.vertex_count());
    switch (dice.below(5)) {
      case 0:
        mesh.facets.push_back({a, b, a});
        break;
      case 1:
        mesh.facets.push_back({a, a, a});
        break;
      case 2:
        mesh.positions.push_back(mesh.positions[a]);
        mesh.facets.push_back({a, b, v});
        break;
      case 3:
        mesh.positions.push_back(mesh.positions[a]);
        mesh.positions.push_back(mesh.positions[a]);
        mesh.facets.push_back({a, v, v + 1});
        break;
      default:
        mesh.positions.push_back(mesh.positions[a] +
                                 (mesh.positions[b] - mesh.positions[a]) * dice.pick({0.5, 0.25, 2.0}));
        mesh.facets.push_back({a, b, v});
    }
  }
}

void own_corners(Mesh& mesh) {
  Mesh apart;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) {
    const auto first = static_cast<Index>(apart.vertex_count());
    for (const Vec3& p : mesh.corners(f)) apart.positions.push_back(p);
    apart.facets.push_back({first, first + 1, first + 2});
  }
  mesh = std::move(apart);
}

void add_unused(Mesh& mesh, Dice& dice) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  mesh.positions.insert(mesh.positions.begin(), dice.pick<Vec3>({{0, 0, 0}, {1e9, -1e9, 3}, {nan, nan, nan}}));
  for (Facet& f : mesh.facets)
    for (Index& v : f) ++v;
  mesh.positions.push_back({1e30, 0, nan});
}

void renumber(Mesh& mesh, Dice& dice) {
  std::vector<Index> order(mesh.vertex_count());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Index>(i);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[dice.below(i)]);
  std::vector<Vec3> moved(mesh.vertex_count());
  for (std::size_t i = 0; i < order.size(); ++i) moved[order[i]] = mesh.positions[i];
  mesh.positions = std::move(moved);
  for (Facet& f : mesh.facets) {
    for (Index& v : f) v = order[v];
    std::rotate(f.begin(), f.begin() + dice.between(0, 2), f.end());
  }
  for (std::size_t i = mesh.facet_count(); i > 1; --i) std::swap(mesh.facets[i - 1], mesh.facets[dice.below(i)]);
}

void turn_over_some(Mesh& mesh, Dice& dice) {
  const bool all = dice.chance(0.5);
  for (Facet& f : mesh.facets)
    if (all || dice.chance(0.5)) std::swap(f[1], f[2]);
}

}  // namespace

std::string_view spoil(Mesh& mesh, Dice& dice, std::size_t most) {
  switch (dice.below(15)) {
    case 0:
      subdivide_some(mesh, dice, most);
      return "some facets subdivided";
    case 1:
      duplicate_some(mesh, dice, most);
      return "facets doubled";
    case 2:
      two_sided(mesh, most);
      return "two-sided";
    case 3:
      add_facets_without_area(mesh, dice);
      return "facets without area";
    case 4:
      if (3 * mesh.facet_count() > 2 * most + 200) return "as it is";
      own_corners(mesh);
      return "facets apart";
    case 5:
      add_unused(mesh, dice);
      return "unused vertices";
    case 6:
      renumber(mesh, dice);
      return "renumbered";
    case 7:
      turn_over_some(mesh, dice);
      return "facets turned over";
    case 8:
      collapse(mesh.positions, used_vertices(mesh), dice);
      return "collapsed";
    case 9:
      scale(mesh.positions, dice.pick({1e-6, 1e6, 0x1p-20, 0x1p20, 3.0}));
      return "scaled";
    case 10:
      shift(mesh.positions, dice.pick<Vec3>({{1e9, 0, 0}, {1e9, -1e9, 1e9}, {0x1p20, 0x1p20, 0}, {1e3, 1, -7}}));
      return "far away";
    case 11:
      turn(mesh.positions, dice);
      return "turned";
    case 12:
      turn_part(mesh.positions, used_vertices(mesh), dice);
      return "a part turned";
    case 13:
      jitter(mesh.positions, used_vertices(mesh), dice, dice.pick({1e-15, 1e-12, 1e-9, 1e-7}));
      return "aligned but for little";
    default:
      snap(mesh.positions, used_vertices(mesh), dice);
      return "on a lattice";
  }
}

}  // namespace morula::properties
