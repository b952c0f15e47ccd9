// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Reason why inner spheres may need growth. A sphere is fitted to the corners that its node owns at that time. Later
// the node's polygons are cut for its children, and go from child to child. The weights of a new cut point are rounded,
// so the point is off the segment that it cuts by up to 5 u A per coordinate, where u = 2^-53 and A is the largest
// |coordinate|. That adds up from cut to cut, and a body whose size is a few thousand u A is not convex at that scale
// any more: a new point can be farther from the center than both ends of its segment. The pad of the sphere, 32 u A,
// holds for a few cuts only.
//
// Proof that d (1 + 8 u) + 8 u C <= r suffices, with d the computed distance of the farthest corner and C the largest
// of A and the center's |coordinates|. A coordinate of a cut point is a sum of three products with weights that add up
// to 1: it is off by at most 3 u A. Its difference to the center adds u |x - c|. So the vector is off by at most
// sqrt(3) 3 u A + u d, and squares, sums and root add 2.5 u d. The true distance is at most d (1 + 4 u) + 5.2 u C, and
// computing the left side costs less than the 4 u d + 2.8 u C that remain.
//
// Proof that spheres of rounded_up_radius, D (1 + 32 u) + 32 u C, stay unchanged. D was measured at the same corners,
// by the same products in another order at most: d is at most D (1 + 8 u) + 10.4 u C, so the left side is at most
// D (1 + 17 u) + 18.5 u C.
#include "tree/wrapping.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/scale.hpp>

namespace morula::detail {
namespace {

double farthest_distance_to(const Vec3& center, std::span<const std::uint32_t> corners, std::span<const Vec3> places) {
  double largest = 0;
  for (const std::uint32_t c : corners) largest = std::max(largest, squared_distance(center, places[c]));
  // The limit of certify(): squares above it have lost no digit.
  if (largest > 0x1p-900) return std::sqrt(largest);
  double farthest = 0;
  for (const std::uint32_t c : corners) farthest = std::max(farthest, scaled_length(places[c] - center));
  return farthest;
}

bool is_proven(const Sphere& sphere, double farthest, double largest_coordinate) {
  // mutant wrapping-as-measured: `0x1p-50` -> `0`
  // mutant wrapping-grows-what-is-fitted: `50` -> `48`
  constexpr double rounding = 0x1p-50;
  // mutant wrapping-without-coordinates: `farthest * ... * rounding` -> `largest_coordinate > 0 && farthest * (1 + rounding)`
  return farthest * (1 + rounding) + largest_coordinate * rounding <= sphere.radius;
}

}  // namespace

LevelGrowth wrap_regions(const MeshView& mesh, CoveredTree& model, Workers& workers) {
  const Cover& cover = model.cover;
  std::vector<Vec3> places(cover.vertex_count + cover.cut_points.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = corner_position(cover, i, mesh.positions);
  const double of_mesh = largest_coordinate(mesh);
  std::vector<double> radii(model.tree.node_count());
  parallel_for(workers, radii.size(), 1, [&](std::size_t node, std::size_t) {
    const Sphere& sphere = model.tree.spheres[node];
    const double largest = std::max(of_mesh, max_norm(sphere.center));
    const double farthest =
        farthest_distance_to(sphere.center, cover.region_corners(static_cast<std::uint32_t>(node)), places);
    radii[node] = is_proven(sphere, farthest, largest) ? sphere.radius : rounded_up_radius(farthest, largest);
  });
  LevelGrowth growth;
  for (std::size_t node = 0; node < radii.size(); ++node) {
    double& radius = model.tree.spheres[node].radius;
    if (radii[node] == radius) continue;
    ++growth.grown;
    growth.largest_growth = std::max(growth.largest_growth, radii[node] - radius);
    growth.largest_factor = std::max(growth.largest_factor, radius > 0 ? radii[node] / radius : 1.0);
    radius = radii[node];
  }
  return growth;
}

}  // namespace morula::detail
