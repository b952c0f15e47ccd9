// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "write/inertia.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/principal_axes.hpp"

namespace morula::robot {

namespace {

using Tensor = std::array<double, 6>;

/// Along the axes of the link, of one along the axes of the inertia's origin.
Tensor turned(const Tensor& tensor, const RigidTransform& origin) {
  const auto [xx, xy, xz, yy, yz, zz] = tensor;
  const std::array<Vec3, 3> columns{Vec3{xx, xy, xz}, Vec3{xy, yy, yz}, Vec3{xz, yz, zz}};
  const auto& r = origin.rows;
  const auto entry = [&](std::size_t i, std::size_t j) {
    const Vec3 v{dot(columns[0], r[j]), dot(columns[1], r[j]), dot(columns[2], r[j])};
    return dot(r[i], v);
  };
  return {entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)};
}

Tensor from_axes(const std::array<Vec3, 3>& axes, const Vec3& moments) {
  Tensor tensor{};
  for (int k = 0; k < 3; ++k) {
    const Vec3& a = axes[static_cast<std::size_t>(k)];
    const Vec3 scaled = moments[k] * a;
    const Tensor part{scaled.x * a.x, scaled.x * a.y, scaled.x * a.z, scaled.y * a.y, scaled.y * a.z, scaled.z * a.z};
    for (std::size_t i = 0; i < 6; ++i) tensor[i] += part[i];
  }
  return tensor;
}

/// Whether moments are nearly those of a solid. One moment of a rod is 0, which is near enough.
bool is_near_solid(const Vec3& moments) {
  const double least = std::min({moments.x, moments.y, moments.z}), most = std::max({moments.x, moments.y, moments.z});
  return std::isfinite(most) && most > 0 && least >= -1e-9 * most;
}

/// Moments of a solid: each above the least one that is taken, no two less than the third. If A + B < C, the nearest
/// solid is flat: the second moment along the axis of C is 0 instead of below, which raises A and B alike.
Vec3 raised(Vec3 moments) {
  const double most = std::max({moments.x, moments.y, moments.z});
  // mutant mjcf-moment-least: `least_moment` -> `0.0`
  for (int i = 0; i < 3; ++i) moments[i] = std::max(moments[i], least_moment);
  for (int i = 0; i < 3; ++i) {
    double &a = moments[(i + 1) % 3], &b = moments[(i + 2) % 3];
    const double lack = moments[i] - (a + b);
    // Rounding must not cancel the added share.
    const double share = 0.5 * lack + 0x1p-40 * most;
    // mutant mjcf-moments-triangle: `-0x1p-40 * most` -> `most`
    if (lack > -0x1p-40 * most) a += share, b += share;
  }
  return moments;
}

/// Whether moments are far enough from all bounds for a reader that recomputes them.
bool is_safe(const Vec3& moments) {
  const double sum = moments.x + moments.y + moments.z;
  const double least = std::min({moments.x, moments.y, moments.z}), most = std::max({moments.x, moments.y, moments.z});
  return least >= std::max(10 * least_moment, 1e-9 * most) && sum - 2 * most >= 1e-9 * most;
}

/// The inertia of a ball with the density of water, for a mass without other data.
Tensor ball_inertia(double mass) {
  const double radius = std::cbrt(mass / (1000 * 4.0 / 3 * std::numbers::pi));
  const double moment = 0.4 * mass * radius * radius;
  return {moment, 0, 0, moment, 0, moment};
}

BodyInertia checked(double mass, const Vec3& center, const Tensor& tensor) {
  // mutant mjcf-mass-least: `std::max(mass, least_mass)` -> `mass`
  BodyInertia result{.mass = std::max(mass, least_mass), .center = center, .matrix = tensor};
  const detail::PrincipalAxes principal = detail::principal_axes(tensor, 0);
  result.moments = principal.moments;
  result.matrix_is_safe = is_safe(result.moments);
  if (!result.matrix_is_safe) {
    result.moments = raised(result.moments);
    result.matrix = from_axes(principal.axes, result.moments);
  }
  const auto& [x, y, z] = principal.axes;
  result.axes = {.rows = {Vec3{x.x, y.x, z.x}, Vec3{x.y, y.y, z.y}, Vec3{x.z, y.z, z.z}}};
  return result;
}

}  // namespace

std::optional<BodyInertia> body_inertia(const Description& d, std::size_t link) {
  const std::optional<Inertial>& own = d.robot.links[link].inertial;
  const LinkSpheres* spheres = d.spheres.of(link);
  const UnionMass* solid = spheres != nullptr && spheres->figures.solid.volume > 0 ? &spheres->figures.solid : nullptr;
  const auto of_spheres = [&](double mass) {
    Tensor tensor = solid->inertia;
    for (double& entry : tensor) entry *= mass / solid->volume;
    return tensor;
  };
  if (own && own->mass > 0) {
    const Tensor tensor = turned(own->inertia, own->origin);
    if (is_near_solid(detail::principal_axes(tensor, 0).moments)) {
      return checked(own->mass, own->origin.translation, tensor);
    }
    return checked(own->mass, own->origin.translation,
                   solid != nullptr ? of_spheres(own->mass) : ball_inertia(own->mass));
  }
  if (!d.options.fill_masses || solid == nullptr) return std::nullopt;
  const double mass = d.options.density * solid->volume;
  return checked(mass, solid->center, of_spheres(mass));
}

}  // namespace morula::robot
