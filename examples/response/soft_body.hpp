// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A soft body for the examples of responses: a lattice of points that springs join, in cells whose outer faces are its
// closed surface. The solvers of stack/, squeeze/, tool/ and ball_on_cloth/ move its points.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <morula/morula.hpp>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

namespace response {

using morula::Vec3;

/// Maps a cube about the origin, -1 to 1, to a ball of radius 1.
inline Vec3 on_ball(const Vec3& p) {
  const double xx = p.x * p.x, yy = p.y * p.y, zz = p.z * p.z;
  return {p.x * std::sqrt(1 - yy / 2 - zz / 2 + yy * zz / 3), p.y * std::sqrt(1 - zz / 2 - xx / 2 + zz * xx / 3),
          p.z * std::sqrt(1 - xx / 2 - yy / 2 + xx * yy / 3)};
}

/// Points with masses that springs join.
struct Points {
  struct Spring {
    std::uint32_t a, b;
    double length;  // at rest
  };
  std::vector<Vec3> x, v, old;  // position and velocity of each point, and its position before the step
  std::vector<double> mass;     // of each point; infinite for one that is held
  std::vector<Spring> springs;

  /// 0 for a point that is held, so that sums of all points have no infinite terms.
  double free_mass(std::size_t p) const { return std::isinf(mass[p]) ? 0.0 : mass[p]; }
  double total_mass() const {
    double sum = 0;
    for (std::size_t p = 0; p < x.size(); ++p) sum += free_mass(p);
    return sum;
  }
  Vec3 center() const {
    Vec3 sum;
    for (std::size_t p = 0; p < x.size(); ++p) sum += free_mass(p) * x[p];
    return sum / total_mass();
  }
  double kinetic_energy() const {
    double sum = 0;
    for (std::size_t p = 0; p < x.size(); ++p) sum += 0.5 * free_mass(p) * squared_length(v[p]);
    return sum;
  }
  /// stiffness: of each spring, force per length.
  double elastic_energy(double stiffness) const {
    double sum = 0;
    for (const Spring& s : springs) sum += 0.5 * stiffness * std::pow(distance(x[s.a], x[s.b]) - s.length, 2);
    return sum;
  }
  /// Adds the forces of all springs to those of the points. damping: force per speed. Returns the heat per time.
  double add_spring_forces(double stiffness, double damping, std::vector<Vec3>& forces) const {
    double heat = 0;
    for (const Spring& s : springs) {
      const Vec3 along = x[s.b] - x[s.a];
      const double now = length(along), speed = dot(v[s.b] - v[s.a], along) / now;
      const Vec3 force = (stiffness * (now - s.length) + damping * speed) / now * along;
      forces[s.a] += force, forces[s.b] -= force;
      heat += damping * speed * speed;
    }
    return heat;
  }
};

/// A box of nx × ny × nz cubes. Springs join all corners of each cube.
class SoftBody : public Points {
 public:
  std::vector<morula::Hexahedron> cells;

  /// place: maps (i, j, k), with i from 0 to cells.x and so on, to a position at rest.
  template <class Place>
  SoftBody(const std::array<std::uint32_t, 3>& n, double total_mass, const Place& place)
      : SoftBody(lattice(n, place), total_mass) {}

  SoftBody(const SoftBody&) = delete;  // the collider borrows body and surface
  SoftBody& operator=(const SoftBody&) = delete;

  const morula::UsedVertices surface;  ///< vertex i of the mesh is point surface.index[i]
  morula::Body body;
  morula::Collider collider;

  /// Passes the present points to the spheres: before every query.
  void update_surface() {
    if (!body.update(morula::PositionView::indexed(x, surface.index)))
      throw std::runtime_error("a point is not finite");
  }
  /// The point of a vertex of the surface.
  std::uint32_t point(std::uint32_t vertex) const { return surface.index[vertex]; }

 private:
  struct Lattice {
    std::vector<Vec3> points;
    std::vector<morula::Hexahedron> cells;
  };

  template <class Place>
  static Lattice lattice(const std::array<std::uint32_t, 3>& n, const Place& place) {
    Lattice made;
    const auto number = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
      return (k * (n[1] + 1) + j) * (n[0] + 1) + i;
    };
    for (std::uint32_t k = 0; k <= n[2]; ++k)
      for (std::uint32_t j = 0; j <= n[1]; ++j)
        for (std::uint32_t i = 0; i <= n[0]; ++i) made.points.push_back(place(i, j, k));
    for (std::uint32_t k = 0; k < n[2]; ++k)
      for (std::uint32_t j = 0; j < n[1]; ++j)
        for (std::uint32_t i = 0; i < n[0]; ++i)
          made.cells.push_back({number(i, j, k), number(i + 1, j, k), number(i + 1, j + 1, k), number(i, j + 1, k),
                                number(i, j, k + 1), number(i + 1, j, k + 1), number(i + 1, j + 1, k + 1),
                                number(i, j + 1, k + 1)});
    return made;
  }

  SoftBody(Lattice made, double total)
      : Points{made.points,
               std::vector<Vec3>(made.points.size()),
               made.points,
               std::vector<double>(made.points.size()),
               {}},
        cells(std::move(made.cells)),
        surface(morula::solid_surface(x, {}, cells)),
        body(surface.mesh, morula::build(surface.mesh, {.method = morula::Method::grid})),
        collider(surface.mesh, body) {
    std::set<std::array<std::uint32_t, 2>> pairs;
    for (const morula::Hexahedron& cell : cells)
      for (std::size_t i = 0; i < 8; ++i) {
        mass[cell[i]] += total / static_cast<double>(8 * cells.size());
        for (std::size_t j = i + 1; j < 8; ++j) pairs.insert({std::min(cell[i], cell[j]), std::max(cell[i], cell[j])});
      }
    for (const auto& [a, b] : pairs) springs.push_back({a, b, distance(x[a], x[b])});
  }
};

}  // namespace response
