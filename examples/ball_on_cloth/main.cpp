// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A soft ball falls on a cloth that is held at its corners, and comes to rest in it. Each pair of features nearer than
// a thickness is a constraint of XPBD. docs/how-to/responses.md says more.
//
// At rest the cloth carries the weight of the ball. Energy never grows, and no two facets ever cross.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <morula/morula.hpp>
#include <stdexcept>
#include <vector>

#include "../response/soft_body.hpp"
#include "../response/xpbd.hpp"

using morula::Vec3;
using response::Points;
using response::SoftBody;

namespace {

constexpr int cells = 16, steps = 6000, averaged_steps = 1000;
constexpr double h = 0.001, gravity = 9.81, thickness = 0.04, drag = 2;
constexpr double cloth_stiffness = 2000, cloth_mass = 0.2, ball_stiffness = 2000, ball_mass = 0.5, ball_radius = 0.3;

/// A square sheet of springs with an edge of 2, held at its corners.
struct Cloth : Points {
  morula::Mesh mesh;
  Cloth() {
    const auto at = [](int i, int j) { return static_cast<std::uint32_t>(j * (cells + 1) + i); };
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) mesh.positions.push_back({2.0 * i / cells - 1, 2.0 * j / cells - 1, 0});
    x = old = mesh.positions;
    v.resize(x.size()), mass.resize(x.size());
    const auto join = [&](std::uint32_t a, std::uint32_t b) { springs.push_back({a, b, distance(x[a], x[b])}); };
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) {
        if (i < cells) join(at(i, j), at(i + 1, j));
        if (j < cells) join(at(i, j), at(i, j + 1));
        if (i == cells || j == cells) continue;
        join(at(i, j), at(i + 1, j + 1)), join(at(i + 1, j), at(i, j + 1));
        mesh.facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        mesh.facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        for (const std::uint32_t p : {at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)})
          mass[p] += cloth_mass / (4 * cells * cells);
      }
    for (const std::uint32_t p : {at(0, 0), at(cells, 0), at(0, cells), at(cells, cells)})
      mass[p] = std::numeric_limits<double>::infinity();
  }
};

class Scene {
 public:
  Cloth cloth;
  SoftBody ball{{4, 4, 4}, ball_mass, [](double i, double j, double k) {
                  return ball_radius * response::on_ball({i / 2 - 1, j / 2 - 1, k / 2 - 1}) + Vec3{0, 0, 0.5};
                }};
  Vec3 force;  // of the cloth on the ball, in the last step
  double nearest = thickness;

  void step() {
    response::predict(cloth, h, gravity), response::predict(ball, h, gravity);
    response::solve_springs(cloth, h, cloth_stiffness), response::solve_springs(ball, h, ball_stiffness);
    solve_contact();
    response::end_step(cloth, h, drag), response::end_step(ball, h, drag);
  }
  double energy() const {
    return cloth.kinetic_energy() + cloth.elastic_energy(cloth_stiffness) + ball.kinetic_energy() +
           ball.elastic_energy(ball_stiffness) +
           gravity * (cloth.total_mass() * cloth.center().z + ball.total_mass() * ball.center().z);
  }
  /// Pairs of facets that cross, by looking at all of them.
  std::size_t crossings() const {
    std::size_t count = 0;
    const auto triangle = [](const Points& of, const std::array<std::uint32_t, 3>& f) {
      return morula::Triangle{of.x[f[0]], of.x[f[1]], of.x[f[2]]};
    };
    for (const morula::Facet& f : cloth.mesh.facets)
      for (const morula::Facet& g : ball.surface.mesh.facets)
        count += intersect(triangle(cloth, f), triangle(ball, {ball.point(g[0]), ball.point(g[1]), ball.point(g[2])}));
    return count;
  }

 private:
  void solve_contact() {
    if (!cloth_tree.update(cloth.x) || !ball_tree.update(morula::PositionView::indexed(ball.x, ball.surface.index)) ||
        !near.run(cloth_tree, ball_tree))
      throw std::runtime_error("a rejected query");
    force = {};
    nearest = thickness;
    for (const morula::ProximityPair& pair : near.pairs()) {
      nearest = std::min(nearest, pair.distance);
      // With the weights u of the nearest points, C = distance - thickness has the derivatives -u n on the cloth and
      // u n on the ball.
      const Vec3 n = pair.direction();
      double w = 0;
      const auto for_points = [&](const auto& use) {
        const auto one = [&](Points& of, std::span<const std::uint32_t> vertices, const morula::Barycentric& u,
                             bool is_ball) {
          for (std::size_t k = 0; k < vertices.size(); ++k)
            use(of, is_ball ? ball.point(vertices[k]) : vertices[k], is_ball ? u[k] : -u[k]);
        };
        const bool is_edges = pair.kind == morula::PairKind::edge_edge;
        const std::array<std::uint32_t, 1> a{pair.a}, b{pair.b};
        (void)b;
        if (is_edges) {
          one(cloth, cloth_tree.edges()[pair.a], pair.weights_a, false);
          one(ball, ball_tree.edges()[pair.b], pair.weights_b, true);
        } else if (pair.kind == morula::PairKind::vertex_facet) {
          one(cloth, a, pair.weights_a, false);
          one(ball, ball_tree.facets()[pair.b], pair.weights_b, true);
        }
      };
      for_points([&](Points& of, std::uint32_t p, double u) { w += u * u / of.mass[p]; });
      const double push = w > 0 ? (thickness - pair.distance) / w : 0;
      for_points([&](Points& of, std::uint32_t p, double u) {
        of.x[p] += push * u / of.mass[p] * n;
        if (&of == &ball) force += push * u * n / (h * h);
      });
    }
  }

  morula::SurfaceTree cloth_tree{cloth.mesh}, ball_tree{ball.surface.mesh};
  morula::ProximityQuery near{{.distance = thickness, .nearest_features_once = true}};
};

}  // namespace

int main() {
  Scene scene;
  const double begin = scene.energy();
  double growth = 0, top = begin;
  std::size_t crossings = 0;
  Vec3 mean;
  for (int k = 1; k <= steps; ++k) {
    scene.step();
    const double now = scene.energy();
    growth = std::max(growth, (now - top) / begin), top = std::min(top, now);
    if (k > steps - averaged_steps) mean += scene.force / averaged_steps;
    if (k % 500 != 0) continue;
    crossings += scene.crossings();
    std::printf(
        "%.1f s: ball at z = %7.4f, nearest features at %.4f, force %7.3f, energy %8.4f, kinetic %.1e, %zu crossings\n",
        k * h, scene.ball.center().z, scene.nearest, scene.force.z, now,
        scene.ball.kinetic_energy() + scene.cloth.kinetic_energy(), crossings);
  }
  std::printf("%g %g %g growth %g\n", mean.x, mean.y, mean.z, growth);
  return 0;
}
