// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Deterministic point sets: on surfaces and on the unit sphere.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <vector>

namespace morula {

struct SurfaceSample {
  std::uint32_t facet;
  std::array<double, 3> barycentric;
  Vec3 point;
};
/// `count` points spread over the surface, area-proportional and stratified (one low-discrepancy sequence over the
/// facets laid end to end by area). Facets of no area get none. Same seed, same points.
std::vector<SurfaceSample> sample_surface(const Mesh& mesh, std::size_t count, std::uint64_t seed = 1);

/// `count` nearly uniform unit directions (Fibonacci lattice).
std::vector<Vec3> fibonacci_directions(std::size_t count);

}  // namespace morula
