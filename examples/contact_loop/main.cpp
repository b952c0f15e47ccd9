// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Two bodies collide under a budget in every frame; examples/python/contacts.py does the same. The loop stands in
// docs/tutorials/contact_loop.md. In every frame a test of all pairs of facets finds the points where the surfaces
// cross; each of them has to lie within the error bound of a contact.
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

/// The crossing points that no contact is near.
std::size_t missed(const std::vector<Vec3>& points, const std::vector<morula::Contact>& contacts) {
  std::size_t count = 0;
  for (const Vec3& p : points) {
    bool is_near = false;
    for (const morula::Contact& contact : contacts)
      is_near = is_near || distance(p, contact.point) <= contact.error_bound + 1e-9;
    count += is_near ? 0 : 1;
  }
  return count;
}

}  // namespace

int main() {
  std::size_t crossings = 0, faults = 0;
  const auto check = [&](const morula::Collider& a, const morula::Collider& b, const morula::Contacts& found) {
    const std::vector<Vec3> points = crossing_points(a, b);
    crossings += points.size();
    faults += missed(points, found.contacts);
    if (found.finished && found.surfaces.size() != found.contacts.size()) ++faults;
  };

  // [contact_loop]
  const morula::Mesh limb = morula::sample_body("limb", 24), tool = morula::sample_body("tool", 24);
  morula::Body limb_body(limb, morula::build(limb)), tool_body(tool, morula::build(tool));
  morula::Collider a(limb, limb_body), b(tool, tool_body);
  morula::ContactQuery query({.budget = std::chrono::microseconds(300), .surfaces = true});
  query.add(a, b);
  for (int frame = 0; frame < 7; ++frame) {
    const std::vector<Vec3> positions = deform(limb, {morula::Bend{60}}, frame / 6.0);  // a solver's
    if (const morula::Status status = limb_body.update(positions); !status) throw std::runtime_error(message(status));
    b.set_transform(morula::RigidTransform::from_axis({1, 0, 0}, 0.1 * frame, {0, 0.8 - 0.05 * frame, 0}));
    const morula::ContactStatus status = frame > 0 ? query.carry() : query.start();
    if (!status) throw std::runtime_error(message(status));
    const morula::Contacts& found = query.contacts();
    Vec3 push;  // a response sums over contacts
    for (const morula::Contact& contact : found.contacts) push += std::max(0.0, contact.depth) * contact.normal;
    std::printf("frame %d: %zu contacts, %s; push %.3f %.3f %.3f\n", frame, found.contacts.size(),
                found.finished ? "all of them" : "as far as the budget reaches", push.x, push.y, push.z);
    check(a, b, found);  // not shown
  }
  // [end]
  std::printf("%zu points where an edge crosses a facet, %zu faults\n", crossings, faults);
  return faults == 0 && crossings > 0 ? 0 : 1;
}
