// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A modal model: a solver that has coordinates instead of positions. No vertex is read while the spheres move.
#include <cmath>
#include <cstdio>
#include <morula/morula.hpp>
#include <numbers>
#include <vector>

int main() {
  const morula::Mesh mesh = morula::sample_body("limb");
  const morula::CoveredTree model = morula::build(mesh);

  // Two modes: bending and twist. A modal analysis would give them, or read_modes("modes.npy", mesh).
  morula::Modes modes{.vertex_count = mesh.vertex_count(), .mode_count = 2, .displacements = {}};
  for (const morula::Vec3& p : mesh.positions) modes.displacements.push_back({0, 0.2 * std::sin(p.x), 0});
  for (const morula::Vec3& p : mesh.positions) modes.displacements.push_back({0, -0.3 * p.x * p.z, 0.3 * p.x * p.y});

  morula::Body body(mesh, model, {.rules = {morula::Rule::modal}, .modes = modes});
  for (int frame = 0; frame <= 60; ++frame) {
    const double phase = 2 * std::numbers::pi * frame / 60;
    const double q[]{std::sin(phase), 0.5 * std::sin(2 * phase)};  // what the solver integrates
    const morula::UpdateStatus status = body.update_modal(q);      // 518 spheres; no vertex is read
    if (!status) return 1;                                         // bad coordinates; the last spheres are kept
  }

  // The proof, and positions to draw, from the same coordinates.
  const double q[]{1.0, -0.5};
  if (!body.update_modal(q)) return 1;
  std::vector<morula::Vec3> positions(mesh.vertex_count());
  morula::move_by_modes(modes, mesh.positions, q, positions);
  std::vector<morula::Sphere> spheres;
  body.copy_spheres(spheres);
  if (!morula::certify(body.cover(), positions, spheres).covered) return 1;

  // Top down, only where needed: is anything of the body above this plane?
  std::vector<std::uint32_t> open{0};
  std::size_t requested = 0, leaves = 0;
  while (!open.empty()) {
    const std::uint32_t node = open.back();
    open.pop_back();
    const morula::Sphere s = body.modal_sphere(node, q);
    ++requested;
    if (s.center.y + s.radius < 0.9) continue;
    leaves += model.tree.is_leaf(node);
    for (std::uint32_t c = 0; c < model.tree.child_count[node]; ++c) open.push_back(model.tree.first_child[node] + c);
  }
  std::printf("%zu leaves may be above, %zu spheres of %zu were requested\n", leaves, requested,
              model.tree.node_count());
}
