// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/sampling.hpp>
#include <morula/geometry/scale.hpp>
#include <morula/geometry/triangle.hpp>
#include <numbers>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;

std::vector<SurfacePoint> sample_surface(const MeshView& mesh, std::size_t count, std::uint64_t seed) {
  const StandardFloats standard;
  require_usable_scale(mesh);
  std::vector<double> area_up_to(mesh.facet_count());
  double total = 0;
  for (std::size_t f = 0; f < mesh.facet_count(); ++f) area_up_to[f] = total += area(mesh.corners(f));
  std::vector<SurfacePoint> samples;
  if (!(total > 0)) return samples;
  samples.reserve(count);
  Random random(seed);
  std::size_t f = 0;
  for (std::size_t i = 0; i < count; ++i) {
    // Takes one sample in each of `count` equal stretches of area.
    const double at = (static_cast<double>(i) + random.uniform()) / static_cast<double>(count) * total;
    while (f + 1 < mesh.facet_count() && area_up_to[f] <= at) ++f;
    const double root = std::sqrt(random.uniform()), along = random.uniform();
    const std::array<double, 3> b{1 - root, root * (1 - along), root * along};
    samples.push_back({static_cast<std::uint32_t>(f), b, at_barycentric(mesh.corners(f), b)});
  }
  return samples;
}

std::vector<Vec3> fibonacci_directions(std::size_t count) {
  const StandardFloats standard;
  std::vector<Vec3> directions;
  directions.reserve(count);
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double ring = std::sqrt(1 - z * z);
    const auto [s, c] = sin_cos(golden_angle * static_cast<double>(i));
    directions.push_back({ring * c, ring * s, z});
  }
  return directions;
}

}  // namespace morula
