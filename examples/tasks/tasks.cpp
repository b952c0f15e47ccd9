// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The tasks of docs/reference/c.md in C++; tasks.py and tasks.c do the same and print the same numbers. Run it in a
// folder with limb.obj, tool.obj and their trees, limb.morula and tool.morula.
#include <algorithm>
#include <cstdio>
#include <initializer_list>
#include <morula/morula.hpp>
#include <stdexcept>

namespace {

// [build]
void build() {
  const morula::Mesh mesh = morula::read_mesh("limb.obj");
  const morula::CoveredTree model = morula::build(mesh);
  morula::write_tree("built.morula", model);
  std::printf("build: %zu spheres on %zu levels\n", model.tree.node_count(), model.tree.level_count());
}
// [end]

// [update]
void update() {
  const morula::Mesh mesh = morula::read_mesh("limb.obj");
  morula::Body body(mesh, morula::read_covered_tree("limb.morula", mesh));
  std::vector<morula::Vec3> positions = mesh.positions;
  for (int frame = 1; frame <= 10; ++frame) {
    for (morula::Vec3& p : positions) p.x *= 1.0625;
    if (const morula::Status status = body.update(positions); !status) throw std::runtime_error(message(status));
  }
  const bool covered = body.certify(positions).covered;
  std::printf("update: root radius %.9g, %s\n", body.sphere(0).radius, covered ? "covered" : "not covered");
}
// [end]

// [contacts]
void contacts() {
  const morula::Mesh limb = morula::read_mesh("limb.obj"), tool = morula::read_mesh("tool.obj");
  const morula::Body limb_body(limb, morula::read_covered_tree("limb.morula", limb));
  const morula::Body tool_body(tool, morula::read_covered_tree("tool.morula", tool));
  morula::Collider a(limb, limb_body), b(tool, tool_body);
  b.set_transform({.translation = {0, 0.75, 0}});
  const morula::Contacts found = morula::collide(a, b);  // {.budget = std::chrono::microseconds(200)} ends it early
  double deepest = 0;
  for (const morula::Contact& contact : found.contacts) deepest = std::max(deepest, contact.depth);
  std::printf("contacts: %zu, deepest %.9g\n", found.contacts.size(), deepest);
}
// [end]

// [distance]
void distance() {
  const morula::Mesh limb = morula::read_mesh("limb.obj"), tool = morula::read_mesh("tool.obj");
  const morula::Body limb_body(limb, morula::read_covered_tree("limb.morula", limb));
  const morula::Body tool_body(tool, morula::read_covered_tree("tool.morula", tool));
  morula::Collider a(limb, limb_body), b(tool, tool_body);
  b.set_transform({.translation = {0, 2, 0}});
  const morula::DistanceBounds bounds = morula::distance(a, b);
  std::printf("distance: %.9g, facets %u and %u\n", bounds.upper, bounds.a.facet, bounds.b.facet);
}
// [end]

// [self_contact]
void self_contact() {
  const morula::Mesh mesh = morula::read_mesh("limb.obj");
  std::vector<morula::Vec3> folded = mesh.positions;
  for (morula::Vec3& p : folded)
    if (p.x < 0) p.x *= -0.875;
  morula::SurfaceTree surface(mesh);
  morula::SurfaceCrossingQuery query;
  if (const morula::Status status = surface.update(folded); !status) throw std::runtime_error(message(status));
  if (const morula::Status status = query.run(surface); !status) throw std::runtime_error(message(status));
  std::printf("self-contact: %zu pairs of facets\n", query.pairs().size());
}
// [end]

// [scene]
void scene() {
  const morula::Mesh mesh = morula::read_mesh("limb.obj");
  const morula::Body body(mesh, morula::read_covered_tree("limb.morula", mesh));
  std::vector<morula::Collider> row(5, morula::Collider(mesh, body));
  morula::Scene scene;
  for (std::size_t i = 0; i < row.size(); ++i) {
    row[i].set_transform({.translation = {0, 0.75 * static_cast<double>(i), 0}});
    scene.add(row[i]);
  }
  if (const morula::SceneStatus status = scene.update(); !status) throw std::runtime_error(message(status));
  std::size_t count = 0;
  for (const morula::ScenePair& pair : scene.pairs()) count += pair.contacts.size();
  std::printf("scene: %zu pairs of bodies, %zu contacts\n", scene.pairs().size(), count);
}
// [end]

}  // namespace

int main() {
  for (const auto task : {build, update, contacts, distance, self_contact, scene}) task();
}
