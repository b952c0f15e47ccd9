// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_body.hpp"

#include <cmath>

#include "collide/pairs/placed_spheres.hpp"

namespace morula::detail {

BodyStamp stamp_of(const Collider& collider) {
  const SphereState& pose = collider.sphere_state();
  return {pose.cover_id, pose.frame, pose.origin, collider.transform()};
}

// A pair test counts r_a as (1 + 2^-20) r_a, r_b as (1 + 2^-19) r_b, and adds 2^-20 (|c_b|_1 + U) + 2^-46 A + 2^-60 and
// the margin (placed_pair.hpp). U, the distance of both origins along an axis, is at most |c_a| + |c_b| + r_a + r_b and
// the margin where the test says that they overlap. So each side's share is below 2^-18 (|c|_1 + r) + 2^-46 A + 2^-60
// and half the margin with 2^-19 of it; here is twice that, which pays for rounding, the kernel's included.
Sphere ball_around(const Collider& collider, double margin) {
  const Sphere root = PlacedSpheres(collider)(0);
  const Spheref& local = collider.sphere_state().spheres[0];
  const double size = static_cast<double>(std::abs(local.center.x) + std::abs(local.center.y) +
                                          std::abs(local.center.z) + local.radius);
  const double far = max_norm(collider.sphere_state().origin) + max_norm(collider.transform().translation);
  const double half = root.radius + 0x1p-17 * size + 0x1p-45 * far + 0x1p-59 + 0.5 * margin * (1 + 0x1p-18);
  return {root.center, half};
}

Box box_around(const Sphere& ball) {
  const Vec3 half{ball.radius, ball.radius, ball.radius};
  return {ball.center - half, ball.center + half};
}

}  // namespace morula::detail
