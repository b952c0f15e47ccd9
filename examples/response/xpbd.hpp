// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Extended position-based dynamics (XPBD) [macklin2016] of soft bodies, one round of constraints a step. Constraints
// move positions, each by its own gradient, so that they keep momentum.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <morula/morula.hpp>

#include "soft_body.hpp"

namespace response {

/// Moves all points by their velocities and gravity, along -z.
inline void predict(Points& body, double h, double gravity) {
  body.old = body.x;
  for (std::size_t p = 0; p < body.x.size(); ++p) {
    if (!std::isinf(body.mass[p])) body.v[p].z -= gravity * h;
    body.x[p] += h * body.v[p];
  }
}

/// C = length - length at rest, of the compliance 1 / stiffness.
inline void solve_springs(Points& body, double h, double stiffness) {
  const double compliance = 1 / (stiffness * h * h);
  for (const Points::Spring& spring : body.springs) {
    const Vec3 along = body.x[spring.a] - body.x[spring.b];
    const double wa = 1 / body.mass[spring.a], wb = 1 / body.mass[spring.b], now = length(along);
    const Vec3 push = (spring.length - now) / ((wa + wb + compliance) * now) * along;
    body.x[spring.a] += wa * push, body.x[spring.b] -= wb * push;
  }
}

/// Velocities from positions. drag: share of the velocity that the air takes, per time.
inline void end_step(Points& body, double h, double drag) {
  for (std::size_t p = 0; p < body.x.size(); ++p) body.v[p] = (1 - drag * h) / h * (body.x[p] - body.old[p]);
}

/// A point of a soft body's surface; of a body that stands still if `body` is null.
struct Site {
  SoftBody* body;
  morula::SurfacePoint at;

  template <class Use>
  void for_corners(const Use& use) const {
    if (!body) return;
    const morula::Facet& facet = body->surface.mesh.facets[at.facet];
    for (std::size_t k = 0; k < 3; ++k) use(body->point(facet[k]), at.barycentric[k]);
  }
  /// Sum of u² / m over the corners, with their barycentric coordinates u: the inverse of the mass that a push moves.
  double inverse_mass() const {
    double sum = 0;
    for_corners([&](std::uint32_t p, double u) { sum += u * u / body->mass[p]; });
    return sum;
  }
  Vec3 moved() const {
    Vec3 sum;
    for_corners([&](std::uint32_t p, double u) { sum += u * (body->x[p] - body->old[p]); });
    return sum;
  }
  void push(const Vec3& by) const {
    for_corners([&](std::uint32_t p, double u) { body->x[p] += u / body->mass[p] * by; });
  }
};

/// Solves C = volume of the sector, for each point of a patch, and friction there. a and b: the bodies of the patch.
/// Points between facets that are all held are left out: nothing can move there. Returns the sum of pushes on a, which
/// are forces times h².
inline Vec3 solve_points(const morula::ContactPatch& patch, SoftBody* a, SoftBody* b, double friction) {
  Vec3 total;
  for (const morula::PatchPoint& point : patch.points) {
    if (!(point.volume > 0) || squared_length(point.force) == 0) continue;
    const Site on_a{a, point.on_a}, on_b{b, point.on_b};
    const double w = on_a.inverse_mass() + on_b.inverse_mass();
    if (w == 0) continue;
    const auto push = [&](const Vec3& by) { on_a.push(by), on_b.push(-by), total += by; };
    // The derivative of the sector's volume by a translation of a is -force.
    const Vec3 normal_push = point.volume / (w * squared_length(point.force)) * point.force;
    push(normal_push);
    // Friction takes back as much of the sliding in this step as Coulomb's law permits.
    Vec3 slide = on_a.moved() - on_b.moved();
    slide -= dot(slide, patch.normal) * patch.normal;
    const double most = friction * length(normal_push), needed = length(slide) / w;
    if (needed > 0) push(-std::min(1.0, most / needed) / w * slide);
  }
  return total;
}

}  // namespace response
