// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Deterministic point sets: on surfaces and on the unit sphere.
#pragma once

#include <cstdint>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/triangle.hpp>
#include <vector>

namespace morula {

/// `count` points on the surface, stratified and proportional to area: one low-discrepancy sequence over the facets,
/// placed end to end by area. Facets without area get none. The same seed gives the same points.
std::vector<SurfacePoint> sample_surface(const MeshView& mesh, std::size_t count, std::uint64_t seed = 1);

/// `count` nearly uniform unit directions (Fibonacci lattice).
std::vector<Vec3> fibonacci_directions(std::size_t count);

}  // namespace morula
