// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A sheet falls on a ball and folds over it: proximity pushes apart, the time of impact limits every step, and no two
// facets ever cross. docs/how-to/features.md says more.
#include <cstdio>
#include <morula/morula.hpp>

using namespace morula;

namespace {

constexpr int cells = 24;
constexpr double thickness = 0.02, step = 0.01, stiffness = 0.6;

/// The ball, which stands still, and the sheet above it, in one mesh.
struct ClothOnBall {
  Mesh mesh = sample_body("blob", 10);
  std::size_t still;  ///< vertices of the ball
  ClothOnBall() {
    const Box box = bounding_box(mesh);
    for (Vec3& p : mesh.positions) p = (p - box.center()) / box.extent().z;
    still = mesh.positions.size();
    const auto corner = [&](int i, int j) {
      return static_cast<std::uint32_t>(still) + static_cast<std::uint32_t>(j * (cells + 1) + i);
    };
    for (int j = 0; j <= cells; ++j)
      for (int i = 0; i <= cells; ++i) mesh.positions.push_back({1.6 * i / cells - 0.8, 1.6 * j / cells - 0.75, 0.56});
    for (int j = 0; j < cells; ++j)
      for (int i = 0; i < cells; ++i) {
        mesh.facets.push_back({corner(i, j), corner(i + 1, j), corner(i + 1, j + 1)});
        mesh.facets.push_back({corner(i, j), corner(i + 1, j + 1), corner(i, j + 1)});
      }
  }
};

/// Pairs of facets without a common vertex that intersect, by looking at all of them.
std::size_t count_crossings(const Mesh& mesh, const std::vector<Vec3>& at) {
  std::size_t count = 0;
  const auto triangle = [&](const Facet& f) { return Triangle{at[f[0]], at[f[1]], at[f[2]]}; };
  for (std::size_t i = 0; i < mesh.facets.size(); ++i)
    for (std::size_t j = i + 1; j < mesh.facets.size(); ++j) {
      bool share = false;
      for (const std::uint32_t v : mesh.facets[i])
        for (const std::uint32_t w : mesh.facets[j]) share = share || v == w;
      if (!share && intersect(triangle(mesh.facets[i]), triangle(mesh.facets[j]))) ++count;
    }
  return count;
}

}  // namespace

int main() {
  const ClothOnBall scene;
  std::vector<Vec3> at = scene.mesh.positions, velocity(at.size());
  SurfaceTree tree(scene.mesh);
  // Neighbors are as near at rest, and of no interest.
  ProximityQuery near({.distance = thickness, .nearest_features_once = true, .filter = {.rings = 1}});
  SweptQuery swept;
  std::size_t contacts = 0, limited = 0;
  const auto is_free = [&](std::uint32_t v) { return v >= scene.still; };

  for (int frame = 0; frame < 120; ++frame) {
    std::vector<Vec3> next = at;
    for (std::uint32_t v = 0; v < at.size(); ++v)
      if (is_free(v)) next[v] += (velocity[v] + Vec3{0, 0, -9.81 * step}) * step;
    // Edges keep their lengths, by positions [mueller2007]; a vertex of the ball never moves.
    for (int round = 0; round < 8; ++round)
      for (const auto& [v, w] : tree.edges()) {
        if (!is_free(v) || !is_free(w)) continue;
        const Vec3 d = next[w] - next[v];
        const double length_now = length(d), length_at_rest = length(tree.rest(w) - tree.rest(v));
        const Vec3 correction = d * (0.5 * stiffness * (1 - length_at_rest / length_now));
        next[v] += correction, next[w] -= correction;
      }
    // What is nearer than the thickness is pushed apart, by the weights of the nearest points.
    if (!tree.update(at) || !near.run(tree)) return 1;
    contacts += near.pairs().size();
    for (const ProximityPair& pair : near.pairs()) {
      const Vec3 push = pair.direction() * (0.6 * (thickness - pair.distance));
      const auto move = [&](std::span<const std::uint32_t> vertices, const Barycentric& weights, double sign) {
        for (std::size_t k = 0; k < vertices.size(); ++k)
          if (is_free(vertices[k])) next[vertices[k]] += push * (sign * weights[k]);
      };
      if (pair.kind == PairKind::edge_edge) {
        move(tree.edges()[pair.a], pair.weights_a, -1), move(tree.edges()[pair.b], pair.weights_b, 1);
      } else {
        move(std::array{pair.a}, pair.weights_a, -1), move(tree.facets()[pair.b], pair.weights_b, 1);
      }
    }
    // Vertices of pairs that would meet stop before they do; those of the others go on. From the twentieth round on
    // they stay where they were: a part of a motion that is no longer than rounding would be that motion again. Every
    // round then stops a vertex that moved, or finds none in what is left, which is as it was and crosses nothing: it
    // ends.
    for (int round = 0;; ++round) {
      if (!tree.update(at, next) || !swept.run(tree)) return 1;
      std::vector<double> share(at.size(), 1.0);
      bool anything_moves = false;
      for (const SweptPair& pair : swept.pairs()) {
        const auto limit = [&](std::span<const std::uint32_t> vertices) {
          for (const std::uint32_t v : vertices) {
            share[v] = round < 20 ? std::min(share[v], 0.8 * pair.time) : 0.0;
            anything_moves = anything_moves || length(next[v] - at[v]) > 0;
          }
        };
        if (pair.kind == PairKind::edge_edge) {
          limit(tree.edges()[pair.a]), limit(tree.edges()[pair.b]);
        } else {
          limit(std::array{pair.a}), limit(tree.facets()[pair.b]);
        }
      }
      if (!anything_moves) break;
      ++limited;
      for (std::size_t v = 0; v < at.size(); ++v)
        if (share[v] < 1) next[v] = at[v] + (next[v] - at[v]) * share[v];
    }
    for (std::size_t v = 0; v < at.size(); ++v) velocity[v] = (next[v] - at[v]) / step * 0.99;
    at = next;
    if (frame % 30 != 29) continue;
    const std::size_t crossings = count_crossings(scene.mesh, at);
    double lowest = at[scene.still].z;
    for (std::size_t v = scene.still; v < at.size(); ++v) lowest = std::min(lowest, at[v].z);
    std::printf("frame %3d: %6zu contacts so far, %3zu steps limited, sheet down to z = %6.3f, %zu crossings\n",
                frame + 1, contacts, limited, lowest, crossings);
    if (crossings != 0) return 1;
  }
  // It has come down over the ball, and could not have without touching.
  double lowest = 0;
  for (std::size_t v = scene.still; v < at.size(); ++v) lowest = std::min(lowest, at[v].z);
  return contacts > 1000 && lowest < 0.3 ? 0 : 1;
}
