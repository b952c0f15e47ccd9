// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Medial balls, the largest balls that fit inside an object, and inner balls: a few of them that fill most of it.
#pragma once

#include <array>
#include <cstdint>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

namespace morula {

/// Balls inside an object with who touches whom.
struct MedialBalls {
  std::vector<Sphere> balls;
  /// Balls next to each other, both ways: ball i has neighbors[neighbor_begin[i]] … neighbors[neighbor_begin[i + 1] −
  /// 1].
  std::vector<std::uint32_t> neighbor_begin{0};
  std::vector<std::uint32_t> neighbors;
};

/// Shrinking balls [ma2012]: one per point, inside the object with no surface inside the ball, touching the surface at
/// the point or near it (within about a fifth of the radius) and at one other place. points, normals: on the surface,
/// with unit outward normals, equally many. Points on sharp edges, with zero or inward normals, and points whose ball
/// does not settle give none; so does an open surface where it has no inside.
/// Adjacent are balls that overlap, one of them among the eight nearest of the other.
/// Same bits for any number of workers. Cost: about six closest-point queries a point.
/// Differs from [ma2012], which asks a cloud of points: here it is the surface itself, so a ball that is done holds
/// none of it, and edges between the facets of a round body must not count for sharp.
MedialBalls shrinking_balls(const SignedDistance& shape, std::span<const Vec3> points, std::span<const Vec3> normals,
                            WorkersOrAll workers = {});

/// Interior Voronoi balls of surface samples [hubbard1996]: centers inside the object, no sample inside a ball, to
/// within 2⁻²⁰ of the samples' box. Between the samples surface can be inside. Samples in one plane have none. Adjacent
/// are balls that share three samples. Throws std::invalid_argument for samples beyond 2^100 of the origin. Cost: about
/// 10 µs and seven signed distances a sample.
MedialBalls voronoi_balls(const SignedDistance& shape, std::span<const Vec3> samples);

struct InnerBallOptions {
  std::size_t candidates = 2000;       ///< points of the surface where balls are looked for
  double margin = 0;                   ///< every ball stays at least so far away from the surface
  double min_radius = 0;               ///< smaller ones are left out
  std::optional<double> max_radius{};  ///< larger ones are made smaller
  std::uint64_t seed = 1;
};

/// Medial balls of a mesh, each as large as its distance to the surface allows less the margin: no facet reaches into
/// one, and the surface winds round its center, so the whole of it is inside. None of a mesh that is not closed and
/// oriented (object.has_volume()). object: of this mesh. Same bits for any number of workers.
std::vector<Sphere> inner_ball_candidates(const MeshView& mesh, const SignedDistance& object,
                                          const InnerBallOptions& options = {}, WorkersOrAll workers = {});

/// At most `count` of the balls, the one that adds most volume first; fewer where the others would add nothing, or once
/// stopped. Volume is counted on a lattice of 40 points along the longest side of their box.
std::vector<Sphere> fullest_balls(std::span<const Sphere> balls, std::size_t count, const std::stop_token& stop = {});

}  // namespace morula
