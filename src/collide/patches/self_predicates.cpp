// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "collide/patches/self_predicates.hpp"

#include <array>

namespace morula::detail {
namespace {

/// Sign of b - a.
int order(double a, double b) {
  return b > a ? 1 : b < a ? -1 : 0;
}

}  // namespace

int perturbation_orient3d(const IndexedPoint& a, const IndexedPoint& b, const IndexedPoint& c, const IndexedPoint& d) {
  std::array<const IndexedPoint*, 4> q{&a, &b, &c, &d};
  int parity = 1;
  const auto put_in_order = [&](std::size_t i, std::size_t j) {
    if (q[i]->index < q[j]->index) return;
    std::swap(q[i], q[j]);
    parity = -parity;
  };
  put_in_order(0, 1), put_in_order(2, 3), put_in_order(0, 2), put_in_order(1, 3), put_in_order(1, 2);
  const Vec3 &q0 = q[0]->at, &q1 = q[1]->at, &q2 = q[2]->at, &q3 = q[3]->at;
  // mutant self-first-point: `return -parity * sign` -> `return parity * sign`
  for (const Projection& projection : projections)
    if (const int sign = orient2d(q1, q2, q3, projection); sign != 0) return -parity * sign;
  const Vec3 u{static_cast<double>(order(q2.x, q3.x)), static_cast<double>(order(q2.y, q3.y)),
               static_cast<double>(order(q2.z, q3.z))};
  if (u != Vec3{}) {
    // mutant self-second-point: `u.z != 0) return u.z < 0` -> `u.z != 0) return u.z > 0`
    if (const int sign = orient2d(q0, q2, q3, projections[0]); sign != 0) return parity * sign;
    if (u.z != 0) return u.z < 0 ? parity : -parity;
    if (u.y != 0) return u.y > 0 ? parity : -parity;
    if (const int sign = orient2d(q0, q2, q3, projections[1]); sign != 0) return parity * sign;
    return u.x < 0 ? parity : -parity;
  }
  // mutant self-third-point: `order(q3.z, q1.z)` -> `order(q1.z, q3.z)`
  if (const int sign = orient2d(q3, q0, q1, projections[0]); sign != 0) return -parity * sign;
  if (const int sign = order(q3.z, q1.z); sign != 0) return -parity * sign;
  if (const int sign = order(q3.y, q1.y); sign != 0) return parity * sign;
  if (const int sign = order(q3.z, q0.z); sign != 0) return parity * sign;
  return parity;
}

int perturbed_orient3d(const IndexedPoint& a, const IndexedPoint& b, const IndexedPoint& c, const IndexedPoint& d) {
  const int sign = orient3d(a.at, b.at, c.at, d.at);
  return sign != 0 ? sign : perturbation_orient3d(a, b, c, d);
}

}  // namespace morula::detail
