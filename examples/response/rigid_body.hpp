// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A rigid body for the examples of responses: a closed mesh with a transform, and its motion where it is free.
#pragma once

#include <array>
#include <morula/morula.hpp>
#include <utility>
#include <vector>

namespace response {

using morula::Vec3;

struct RigidBody {
  explicit RigidBody(morula::Mesh made)
      : mesh(std::move(made)),
        body(mesh, morula::build(mesh, {.method = morula::Method::grid})),
        collider(mesh, body) {}
  RigidBody(const RigidBody&) = delete;  // the collider borrows body and mesh
  RigidBody& operator=(const RigidBody&) = delete;

  morula::Mesh mesh;
  morula::Body body;
  morula::Collider collider;
  double mass = 1;
  Vec3 inertia{1, 1, 1};  // about the axes of the mesh's coordinates, whose origin is the center of mass
  Vec3 velocity, spin;

  Vec3 center() const { return collider.transform().translation; }
  Vec3 velocity_at(const Vec3& p) const { return velocity + cross(spin, p - center()); }

  /// A step of semi-implicit Euler. torque: about the center of mass.
  void advance(double h, const Vec3& force, const Vec3& torque) {
    morula::RigidTransform pose = collider.transform();
    velocity += h / mass * force;
    const Vec3 local = pose.inverse_rotate(spin);
    const Vec3 momentum{inertia.x * local.x, inertia.y * local.y, inertia.z * local.z};
    const Vec3 rate = pose.inverse_rotate(torque) - cross(local, momentum);  // Euler's equations
    spin += h * pose.rotate({rate.x / inertia.x, rate.y / inertia.y, rate.z / inertia.z});
    const auto turn = morula::RigidTransform::from_axis(spin, length(spin) * h);
    pose.rows = orthonormalized(relative_to(inverse(turn), {pose.rows, {}})).rows;
    pose.translation += h * velocity;
    collider.set_transform(pose);
  }
};

/// An axis-parallel box of two facets a side.
inline morula::Mesh box(const Vec3& lower, const Vec3& upper) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i)
    corners.emplace_back(i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z);
  return morula::solid_surface(corners, {}, std::vector<morula::Hexahedron>{{0, 1, 3, 2, 4, 5, 7, 6}}).mesh;
}

}  // namespace response
