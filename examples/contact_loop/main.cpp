// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The overlap of two bodies under a budget in every frame; examples/python/contacts.py does the same. The loop stands
// in docs/tutorials/contact_loop.md. In every frame a test of all pairs of facets finds the points where the surfaces
// cross: patches have as many, and where a budget ended the run, each lies within the error bound of a contact.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <morula/morula.hpp>
#include <stdexcept>
#include <vector>

using morula::Vec3;

namespace {

/// Appends the point where each edge of one triangle passes through the other triangle.
void add_crossings(const morula::Triangle& edges, const morula::Triangle& facet, std::vector<Vec3>& points) {
  const Vec3 normal = area_vector(facet);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from = edges[i], along = edges[(i + 1) % 3] - from;
    const double share = dot(facet[0] - from, normal) / dot(along, normal);
    if (!(share >= 0 && share <= 1)) continue;  // false for an edge in the plane, too
    const Vec3 p = from + share * along;
    bool is_inside = true;
    for (std::size_t k = 0; k < 3; ++k)
      is_inside = is_inside && dot(cross(facet[(k + 1) % 3] - facet[k], p - facet[k]), normal) >= 0;
    if (is_inside) points.push_back(p);
  }
}

std::vector<Vec3> crossing_points(const morula::Collider& a, const morula::Collider& b) {
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < a.mesh_facets().size(); ++i) {
    for (std::uint32_t j = 0; j < b.mesh_facets().size(); ++j) {
      add_crossings(a.triangle(i), b.triangle(j), points);
      add_crossings(b.triangle(j), a.triangle(i), points);
    }
  }
  return points;
}

/// True if the run is right about the points where surfaces cross.
bool agrees(const morula::ContactPatchQuery& query, const std::vector<Vec3>& points) {
  std::size_t count = 0;
  for (const morula::ContactPatch& patch : query.patches()) count += patch.crossing_count;
  if (query.finished()) return 2 * count == points.size();  // an edge is of two facets
  return std::all_of(points.begin(), points.end(), [&](const Vec3& p) {
    return std::any_of(query.contacts().begin(), query.contacts().end(), [&](const morula::Contact& contact) {
      return distance(p, contact.point) <= contact.error_bound + 1e-9;
    });
  });
}

}  // namespace

int main() {
  constexpr double stiffness = 1000;
  std::size_t crossings = 0, faults = 0;
  const auto check = [&](const morula::Collider& a, const morula::Collider& b, const morula::ContactPatchQuery& query) {
    const std::vector<Vec3> points = crossing_points(a, b);
    morula::ContactPatchQuery complete(a, b);
    crossings += points.size();
    if (!complete.run() || !complete.finished() || !agrees(complete, points) || !agrees(query, points)) ++faults;
    if (query.finished() && query.volume() != complete.volume()) ++faults;
  };

  // [contact_loop]
  const morula::Mesh limb = morula::sample_body("limb", 24), tool = morula::sample_body("tool", 24);
  morula::Body limb_body(limb, morula::build(limb)), tool_body(tool, morula::build(tool));
  morula::Collider a(limb, limb_body), b(tool, tool_body);
  morula::ContactPatchQuery query(a, b);  // once: it keeps its memory
  Vec3 force;                             // on the tool
  for (int frame = 0; frame < 7; ++frame) {
    const std::vector<Vec3> positions = deform(limb, {morula::Bend{60}}, frame / 6.0);  // a solver's
    if (const morula::Status status = limb_body.update(positions); !status) throw std::runtime_error(message(status));
    b.set_transform(morula::RigidTransform::from_axis({1, 0, 0}, 0.1 * frame, {0, 0.85 - 0.02 * frame, 0}));
    const morula::Status status =
        query.run({.max_points = 0, .depths = false, .budget = std::chrono::microseconds(500)});
    if (!status) throw std::runtime_error(message(status));
    if (query.finished() || query.contacts().empty()) force = {};  // otherwise that of the last frame stays
    for (const morula::ContactPatch& patch : query.patches())      // the energy is stiffness / 2 · volume²
      force -= stiffness * query.volume() * patch.b.area_vector;
    std::printf("frame %d: %zu patches, volume %.5f, force %.3f %.3f %.3f%s\n", frame, query.patches().size(),
                query.volume(), force.x, force.y, force.z, query.finished() ? "" : "; the budget ended the run");
    check(a, b, query);  // not shown
  }
  // [end]
  std::printf("%zu points where an edge crosses a facet, %zu faults\n", crossings, faults);
  return faults == 0 && crossings > 0 ? 0 : 1;
}
