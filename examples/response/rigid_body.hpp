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

  /// A step of semi-implicit Euler. torque: about the center of mass. Without one the angular momentum stays the same.
  void advance(double h, const Vec3& force, const Vec3& torque) {
    morula::RigidTransform pose = collider.transform();
    velocity += h / mass * force;
    const Vec3 local = pose.inverse_rotate(spin);
    const Vec3 momentum = pose.rotate({inertia.x * local.x, inertia.y * local.y, inertia.z * local.z}) + h * torque;
    const auto spin_in_pose = [&] {
      const Vec3 l = pose.inverse_rotate(momentum);
      return pose.rotate({l.x / inertia.x, l.y / inertia.y, l.z / inertia.z});
    };
    const auto turned = [](const auto& rows, const Vec3& by) {
      const auto turn = morula::RigidTransform::from_axis(by, length(by));
      return orthonormalized(relative_to(inverse(turn), {rows, {}})).rows;
    };
    // The spin in the middle of the step turns the body: that at its beginning would add energy.
    const auto rows = pose.rows;
    pose.rows = turned(rows, h / 2 * spin_in_pose());
    pose.rows = turned(rows, h * spin_in_pose());
    spin = spin_in_pose();
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
