// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A soft ball falls on a cloth that is held at its corners, and comes to rest in it. A cloth has no volume, so contact
// is a layer about both surfaces: XPBD removes the energy of each layer patch by its gradients.
// docs/how-to/responses.md says more.
//
// At rest the cloth carries the weight of the ball, nothing moves, and no facets have crossed.
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

constexpr int cells = 16, steps = 12000, averaged_steps = 2000;
constexpr double h = 0.0005, gravity = 9.81, thickness = 0.04, drag = 2;
constexpr double cloth_stiffness = 500, cloth_mass = 0.5, ball_stiffness = 2000, ball_mass = 0.5, ball_radius = 0.3;

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
  Vec3 force;            // of the cloth on the ball, in the last step
  double imbalance = 0;  // largest sum of the forces on both

  void step() {
    response::predict(cloth, h, gravity), response::predict(ball, h, gravity);
    response::solve_springs(cloth, h, cloth_stiffness), response::solve_springs(ball, h, ball_stiffness);
    solve_contact();
    response::end_step(cloth, h, drag), response::end_step(ball, h, drag);
  }
  double kinetic_energy() const { return cloth.kinetic_energy() + ball.kinetic_energy(); }
  double energy() const {
    return kinetic_energy() + cloth.elastic_energy(cloth_stiffness) + ball.elastic_energy(ball_stiffness) +
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
        !query.run(cloth_tree, ball_tree))
      throw std::runtime_error("a rejected query");
    force = {};
    Vec3 on_cloth;
    for (const morula::LayerPatch& patch : query.patches()) {
      // The energy of a layer is C² / 2 with C = sqrt(2 V), whose gradients are those of V, divided by C.
      double w = 0;
      for (const morula::VertexGradient& g : patch.a.gradients) w += squared_length(g.gradient) / cloth.mass[g.vertex];
      for (const morula::VertexGradient& g : patch.b.gradients)
        w += squared_length(g.gradient) / ball.mass[ball.point(g.vertex)];
      if (w == 0) continue;
      const double push = -2 * patch.volume / w;
      for (const morula::VertexGradient& g : patch.a.gradients)
        cloth.x[g.vertex] += push / cloth.mass[g.vertex] * g.gradient, on_cloth += push / (h * h) * g.gradient;
      for (const morula::VertexGradient& g : patch.b.gradients) {
        ball.x[ball.point(g.vertex)] += push / ball.mass[ball.point(g.vertex)] * g.gradient;
        force += push / (h * h) * g.gradient;
      }
    }
    imbalance = std::max(imbalance, length(force + on_cloth));
  }

  morula::SurfaceTree cloth_tree{cloth.mesh}, ball_tree{ball.surface.mesh};
  morula::LayerPatchQuery query{{.thickness = thickness, .max_points = 0}};
};

}  // namespace

int main() {
  Scene scene;
  const double begin = scene.energy();
  double growth = 0, least = begin;
  std::size_t crossings = 0;
  Vec3 mean;  // of the force on the ball in the last second
  for (int k = 1; k <= steps; ++k) {
    scene.step();
    const double energy = scene.energy();
    growth = std::max(growth, energy - least), least = std::min(least, energy);
    if (k > steps - averaged_steps) mean += scene.force / averaged_steps;
    if (k % 1000 != 0) continue;
    crossings += scene.crossings();
    std::printf("%.1f s: ball at z = %7.4f, force of the cloth %6.3f, energy %7.4f, kinetic energy %.1e\n", k * h,
                scene.ball.center().z, scene.force.z, energy, scene.kinetic_energy());
  }
  const Vec3 weight{0, 0, gravity * scene.ball.total_mass()};
  const double above = scene.ball.center().z - scene.cloth.x[scene.cloth.x.size() / 2].z;
  std::printf(
      "mean force of the last second %.4f, weight of the ball %.4f; the cloth's middle is %.3f below its center\n",
      mean.z, weight.z, above);
  std::printf("energy grew by at most %.1e of %.2f; forces on both bodies differ by %.1e; %zu crossings\n", growth,
              begin, scene.imbalance, crossings);
  return crossings == 0 && length(mean - weight) < 0.002 * weight.z && scene.kinetic_energy() < 1e-4 &&
                 growth < 0.02 * begin && scene.imbalance < 1e-9 * weight.z && above > 0.8 * ball_radius
             ? 0
             : 1;
}
