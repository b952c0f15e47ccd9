// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Medial balls, the largest balls that fit inside an object, and inner balls, a few balls that fill most of it.
#pragma once

#include <array>
#include <cstdint>
#include <morula/parallel/threads.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/query/signed_distance.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula {

/// Balls inside an object, with their adjacency.
struct MedialBalls {
  std::vector<Sphere> balls;
  /// Adjacent balls, in both directions: ball i has neighbors[neighbor_begin[i]] … neighbors[neighbor_begin[i + 1] −
  /// 1].
  std::vector<std::uint32_t> neighbor_begin{0};
  std::vector<std::uint32_t> neighbors;
};

/// Shrinking balls [ma2012]: one ball per point, inside the object and without surface inside it. It touches the
/// surface at the point or near it (within about a fifth of the radius) and at one other place. points, normals: on the
/// surface, with outward unit normals, equally many. Some points give no ball: points on sharp edges, points with zero
/// or inward normals, points whose ball does not converge, and points of an open surface without an inside. Balls are
/// adjacent if they overlap and one is among the eight nearest of the other.
///
/// The result has the same bits for any number of workers. Cost: about six closest-point queries per point. [ma2012]
/// queries a cloud of points; this function queries the surface itself, so a converged ball contains no surface, and
/// edges between the facets of a round body do not count as sharp.
MedialBalls shrinking_balls(const SignedDistance& shape, std::span<const Vec3> points, std::span<const Vec3> normals,
                            WorkersOrAll workers = {});

/// Interior Voronoi balls of surface samples [hubbard1996]: centers inside the object, no sample inside a ball, within
/// 2⁻²⁰ of the samples' box. Surface between the samples may be inside. Samples in one plane have no balls. Balls are
/// adjacent if they share three samples. Throws std::invalid_argument for samples beyond 2^100 of the origin. Cost:
/// about 10 µs and seven signed distances per sample.
MedialBalls voronoi_balls(const SignedDistance& shape, std::span<const Vec3> samples);

struct InnerBallOptions {
  std::size_t candidates = 2000;       ///< number of surface points from which balls are searched
  double margin = 0;                   ///< least distance of every ball from the surface, mesh units
  double min_radius = 0;               ///< radius below which balls are dropped, mesh units
  std::optional<double> max_radius{};  ///< radius to which larger balls are reduced, mesh units
  std::uint64_t seed = 1;
};

/// Medial balls of a mesh, each with a radius of its distance to the surface less the margin: no facet reaches into a
/// ball, and the winding number at its center is not 0, so the whole ball is inside. Empty for a mesh that is not
/// closed and oriented (object.has_volume()). object: of this mesh. The result has the same bits for any number of
/// workers.
std::vector<Sphere> inner_ball_candidates(const MeshView& mesh, const SignedDistance& object,
                                          const InnerBallOptions& options = {}, WorkersOrAll workers = {});

/// At most `count` of the balls, in the order of the volume that they add; fewer if the others add nothing, or after a
/// stop request. The volume is measured on a lattice of 40 points along the longest side of their box.
std::vector<Sphere> fullest_balls(std::span<const Sphere> balls, std::size_t count, const StopToken& stop = {});

}  // namespace morula
