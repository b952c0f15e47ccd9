// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Fifty soft bodies fall into a box: a broad phase says which are near, proximity pushes them apart, and no vertex
// moves farther than is safe, so that no two surfaces ever cross. docs/how-to/scene.md says more.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <morula/morula.hpp>

using namespace morula;

namespace {

constexpr int body_count = 50, steps = 1000;
constexpr double reach = 0.06, step = 0.01, room = 1.0;

struct SoftBody {
  Mesh mesh;
  std::vector<Vec3> at, velocity, next;
  std::vector<double> safe;  // how far each vertex may move in this step
  SurfaceTree tree;
  std::uint32_t box = 0;
  explicit SoftBody(const Mesh& m)
      : mesh(m), at(m.positions), velocity(at.size()), next(at), safe(at.size()), tree(mesh) {}

  // Every two vertices keep their distance, a little: the body bends and comes back.
  void keep_shape() {
    for (std::size_t v = 0; v < at.size(); ++v)
      for (std::size_t w = v + 1; w < at.size(); ++w) {
        const Vec3 d = next[w] - next[v];
        const double now = length(d), rest = distance(mesh.positions[w], mesh.positions[v]);
        const Vec3 correction = now > 0 ? d * (2 / static_cast<double>(at.size()) * (1 - rest / now)) : Vec3{};
        next[v] += correction, next[w] -= correction;
      }
  }
  Box box_around() const {
    Box around;
    for (const Vec3& p : at) around.add(p);
    const Vec3 half{reach / 2, reach / 2, reach / 2};
    return {around.lower - half, around.upper + half};
  }
};

std::size_t crossings(const SoftBody& a, const SoftBody& b) {
  std::size_t count = 0;
  for (const Facet& f : a.mesh.facets)
    for (const Facet& g : b.mesh.facets)
      count += intersect(Triangle{a.at[f[0]], a.at[f[1]], a.at[f[2]]}, Triangle{b.at[g[0]], b.at[g[1]], b.at[g[2]]});
  return count;
}

}  // namespace

int main() {
  Mesh blob = sample_body("blob", 4);
  const Box extent = bounding_box(blob);
  for (Vec3& p : blob.positions) p = (p - extent.center()) * (0.6 / extent.diagonal());
  std::vector<std::unique_ptr<SoftBody>> bodies;
  BroadPhase broad;
  for (int i = 0; i < body_count; ++i) {
    Mesh placed = blob;
    const Vec3 where{0.65 * (i % 3 - 1), 0.65 * (i / 3 % 3 - 1), 0.5 + 0.65 * (i / 9)};
    const RigidTransform turned = RigidTransform::from_axis({1, 0.3 * i, 0.2}, 0.7 * i, where);
    for (Vec3& p : placed.positions) p = turned(p);
    bodies.push_back(std::make_unique<SoftBody>(placed));
    bodies.back()->box = broad.add(bodies.back()->box_around());
  }
  ProximityQuery near({.distance = reach});
  std::size_t contacts = 0;
  for (int frame = 0; frame < steps; ++frame) {
    for (const auto& body : bodies) {
      for (std::size_t v = 0; v < body->at.size(); ++v)
        body->next[v] = body->at[v] + (body->velocity[v] + Vec3{0, 0, -2 * step}) * step;
      body->keep_shape();
      // What is farther apart than the reach cannot meet while both stay within half of it.
      std::fill(body->safe.begin(), body->safe.end(), 0.45 * reach);
      if (!body->tree.update(body->at) || !broad.move(body->box, body->box_around())) return 1;
    }
    broad.update();
    for (const BoxPair& pair : broad.pairs()) {
      SoftBody &a = *bodies[pair.a], &b = *bodies[pair.b];
      if (!near.run(a.tree, b.tree)) return 1;
      contacts += near.pairs().size();
      for (const ProximityPair& p : near.pairs()) {
        const Vec3 push = p.direction() * (0.3 * std::max(0.0, reach / 2 - p.distance));
        const auto take = [&](SoftBody& body, std::span<const std::uint32_t> vertices, const Barycentric& weights,
                              double sign) {
          for (std::size_t k = 0; k < vertices.size(); ++k) {
            body.next[vertices[k]] += push * (sign * weights[k]);
            body.safe[vertices[k]] = std::min(body.safe[vertices[k]], 0.45 * p.distance);
          }
        };
        const auto side = [&](SoftBody& body, bool is_vertex, std::uint32_t number, const Barycentric& weights,
                              double sign) {
          if (p.kind == PairKind::edge_edge) return take(body, body.tree.edges()[number], weights, sign);
          if (is_vertex) return take(body, std::array{number}, weights, sign);
          take(body, body.tree.facets()[number], weights, sign);
        };
        side(a, p.kind == PairKind::vertex_facet, p.a, p.weights_a, -1);
        side(b, p.kind == PairKind::facet_vertex, p.b, p.weights_b, 1);
      }
    }
    for (const auto& body : bodies)
      for (std::size_t v = 0; v < body->at.size(); ++v) {
        Vec3& to = body->next[v];
        to = {std::clamp(to.x, -room, room), std::clamp(to.y, -room, room), std::max(to.z, 0.0)};
        Vec3 way = to - body->at[v];
        if (const double far = length(way); far > body->safe[v]) way = way * (body->safe[v] / far);
        body->velocity[v] = way * (0.995 / step);
        body->at[v] = body->at[v] + way;
      }
    if (frame % 250 != 249) continue;
    std::size_t crossing = 0;
    double height = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (const Vec3& p : bodies[i]->at) height += p.z;
      for (std::size_t j = i + 1; j < bodies.size(); ++j) crossing += crossings(*bodies[i], *bodies[j]);
    }
    height /= static_cast<double>(bodies.size() * blob.positions.size());
    std::printf("step %4d: %9zu near pairs of features so far, mean height %.3f, %zu crossings\n", frame + 1, contacts,
                height, crossing);
    if (crossing != 0) return 1;
  }
  // They have met, or there was nothing to keep apart.
  return contacts > 10000 ? 0 : 1;
}
