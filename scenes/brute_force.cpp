// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "brute_force.hpp"

#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <numbers>

namespace morula::brute_force {

ClosestFacetPoint closest_point(const Mesh& mesh, const Vec3& p) {
  std::uint32_t nearest = 0;
  TrianglePoint best = morula::closest_point(mesh.corners(0), p);
  for (std::uint32_t f = 1; f < mesh.facet_count(); ++f) {
    const TrianglePoint found = morula::closest_point(mesh.corners(f), p);
    if (found.squared_distance < best.squared_distance) nearest = f, best = found;
  }
  return {{nearest, best.barycentric, best.point}, best.squared_distance};
}

std::vector<std::uint32_t> facets_touching(const Mesh& mesh, const Sphere& ball) {
  std::vector<std::uint32_t> facets;
  if (!(ball.radius >= 0)) return facets;
  for (std::uint32_t f = 0; f < mesh.facet_count(); ++f)
    if (morula::closest_point(mesh.corners(f), ball.center).squared_distance <= ball.radius * ball.radius)
      facets.push_back(f);
  return facets;
}

double winding_number(const Mesh& mesh, const Vec3& p) {
  double sum = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) sum += solid_angle(mesh.corners(f), p);
  return sum / (4 * std::numbers::pi);
}

double inside_volume(const Mesh& mesh, const Sphere& ball, std::size_t samples, std::uint64_t seed) {
  // One point in each cell of a cube of n³ cells, carried to the ball by a map that keeps volume: cube root of the
  // first coordinate for the radius, height and longitude on the sphere from the others.
  const auto n = std::max<std::size_t>(1, static_cast<std::size_t>(std::cbrt(static_cast<double>(samples)) + 0.5));
  Random random(seed);
  std::size_t inside = 0;
  for (std::size_t i = 0; i < n * n * n; ++i) {
    const auto within = [&](std::size_t cell) {
      return (static_cast<double>(cell) + random.uniform()) / static_cast<double>(n);
    };
    const double radius = ball.radius * std::cbrt(within(i % n));
    const double height = 1 - 2 * within(i / n % n);
    const auto [s, c] = sin_cos(2 * std::numbers::pi * within(i / (n * n)));
    const double ring = std::sqrt(1 - height * height);
    const Vec3 p = ball.center + Vec3{ring * c, ring * s, height} * radius;
    if (winding_number(mesh, p) > 0.5) ++inside;
  }
  return volume(ball) * static_cast<double>(inside) / static_cast<double>(n * n * n);
}

}  // namespace morula::brute_force
