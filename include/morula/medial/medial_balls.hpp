// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Medial balls: the largest balls that fit inside an object.
#pragma once

#include <array>
#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <span>
#include <vector>

namespace morula {

/// Balls inside an object with who touches whom.
struct MedialBalls {
  std::vector<Sphere> balls;
  /// Balls next to each other, both ways: ball i has neighbors[neighbor_begin[i]] … neighbors[neighbor_begin[i + 1] − 1].
  std::vector<std::uint32_t> neighbor_begin{0};
  std::vector<std::uint32_t> neighbors;
};

/// Shrinking balls [ma2012]: one per point, touching the surface at the point and at one other place, with no surface
/// inside. points, normals: on the surface, with unit outward normals, equally many. Points whose ball does not settle
/// give none. Adjacent are balls that overlap among the nearest few.
/// Same bits for any number of workers. Cost: about five closest-point queries a point.
MedialBalls shrinking_balls(const SignedDistance& shape, std::span<const Vec3> points, std::span<const Vec3> normals,
                            Workers& workers = serial_workers());

/// Interior Voronoi balls of surface samples [hubbard1996]: centres inside the object, no sample inside a ball.
/// Adjacent are balls that share three samples. Cost: about 20 µs a sample.
MedialBalls voronoi_balls(const SignedDistance& shape, std::span<const Vec3> samples);

}  // namespace morula
