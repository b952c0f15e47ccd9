// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A solver that owns its buffer: Morula reads the surface nodes where they are. docs/how-to/update.md explains it.
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <morula/morula.hpp>

// Stands for your solver: a bar of 16 × 5 × 5 nodes joined by springs, held at one end. Its nodes are records of its
// own, those inside the bar among them.
struct Node {
  double mass = 0.01;
  double position[3];
  double velocity[3] = {};
};
struct Bar {
  static constexpr std::array<int, 3> size{16, 5, 5};
  std::vector<Node> nodes;

  static std::uint32_t number(int i, int j, int k) {
    return static_cast<std::uint32_t>((i * size[1] + j) * size[2] + k);
  }
  Bar() {
    for (int i = 0; i < size[0]; ++i)
      for (int j = 0; j < size[1]; ++j)
        for (int k = 0; k < size[2]; ++k) nodes.push_back({.position = {0.1 * i, 0.1 * j, 0.1 * k}});
  }
  void pull(Node& a, Node& b, double rest_length, double seconds) {
    double offset[3], squared = 0;
    for (int x = 0; x < 3; ++x) offset[x] = b.position[x] - a.position[x], squared += offset[x] * offset[x];
    const double length = std::sqrt(squared), force = 400 * (length - rest_length) / length;
    for (int x = 0; x < 3; ++x) {
      a.velocity[x] += seconds * force * offset[x] / a.mass;
      b.velocity[x] -= seconds * force * offset[x] / b.mass;
    }
  }
  void step(double seconds) {
    for (int i = 0; i < size[0]; ++i)
      for (int j = 0; j < size[1]; ++j)
        for (int k = 0; k < size[2]; ++k)
          for (int n = 14; n < 27; ++n) {  // half of the neighbors: the others look back
            const int di = n / 9 - 1, dj = n / 3 % 3 - 1, dk = n % 3 - 1;
            const int p = i + di, q = j + dj, r = k + dk;
            if (p >= size[0] || q < 0 || q >= size[1] || r < 0 || r >= size[2]) continue;
            pull(nodes[number(i, j, k)], nodes[number(p, q, r)], 0.1 * std::sqrt(di * di + dj * dj + dk * dk), seconds);
          }
    for (std::size_t n = number(1, 0, 0); n < nodes.size(); ++n)  // the first slice is held
      for (int x = 0; x < 3; ++x) {
        nodes[n].velocity[x] = 0.999 * nodes[n].velocity[x] - (x == 2 ? 10 * seconds : 0);
        nodes[n].position[x] += seconds * nodes[n].velocity[x];
      }
  }
};

// The surface as a mesh of its own. Vertex i of it is node index[i] of the solver.
morula::Mesh surface(const Bar& bar, std::vector<std::uint32_t>& index) {
  morula::Mesh mesh;
  std::map<std::uint32_t, std::uint32_t> vertex_of;
  const auto vertex = [&](std::array<int, 3> at) {
    const std::uint32_t node = Bar::number(at[0], at[1], at[2]);
    const auto [found, is_new] = vertex_of.emplace(node, static_cast<std::uint32_t>(index.size()));
    if (is_new) {
      index.push_back(node);
      const double* p = bar.nodes[node].position;
      mesh.positions.push_back({p[0], p[1], p[2]});
    }
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool upper : {false, true})
      for (int i = 0; i + 1 < Bar::size[u]; ++i)
        for (int j = 0; j + 1 < Bar::size[v]; ++j) {
          std::array<std::uint32_t, 4> corner;
          for (int c = 0; c < 4; ++c) {
            std::array<int, 3> at;
            at[axis] = upper ? Bar::size[axis] - 1 : 0;
            at[u] = i + (c == 1 || c == 2), at[v] = j + (c >= 2);
            corner[c] = vertex(at);
          }
          if (!upper) std::swap(corner[1], corner[3]);  // counter-clockwise from outside
          mesh.facets.push_back({corner[0], corner[1], corner[2]});
          mesh.facets.push_back({corner[0], corner[2], corner[3]});
        }
  }
  return mesh;
}

int main() {
  Bar bar;
  std::vector<std::uint32_t> index;
  const morula::Mesh mesh = surface(bar, index);
  morula::Body body(mesh, morula::build(mesh));

  // Made once: nodes and index stay where they are. A buffer that moves or grows needs a new view.
  const auto nodes = morula::PositionView::strided(&bar.nodes[0].position[0], bar.nodes.size(), sizeof(Node));
  const auto view = morula::PositionView::indexed(nodes, index);

  std::vector<morula::Sphere> spheres;
  for (int frame = 0; frame < 120; ++frame) {
    for (int step = 0; step < 40; ++step) bar.step(1.0 / 60 / 40);

    const morula::UpdateStatus status = body.update(view);  // no copy, no allocation
    if (!status) {  // the solver blew up: the spheres are still those of the last good frame
      const std::size_t vertex = status.index;
      std::printf("frame %d: vertex %zu, node %u, is not finite\n", frame, vertex, index[vertex]);
      return 1;
    }
    // A check for tests and for doubters; the spheres of `exact` always pass.
    body.copy_spheres(spheres);
    if (!morula::certify(body.cover(), view, spheres).covered) return 1;
  }
  const morula::Sphere& root = spheres[0];
  std::printf("%zu of %zu nodes are on the surface; in the end all of it is in a ball of radius %.3f about z = %.3f\n",
              index.size(), bar.nodes.size(), root.radius, root.center.z);
}
