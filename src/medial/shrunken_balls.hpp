// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Shrinking balls without their neighbors.
#pragma once

#include <morula/medial/medial_balls.hpp>
#include <morula/parallel/workers.hpp>
#include <vector>

namespace morula::detail {

/// Whether points share a ball where the body is round. The distances from the middle of a round body to its surface
/// are about equal, so finding the nearest point takes longest there.
enum class BallSharing { none, on_round_parts };

/// The balls of shrinking_balls, in the order of their points. On round parts: a point that touches two balls of
/// earlier points, to within 0.003 of their radius and 4°, has the first of them, unless the three normals lie in about
/// one plane, as those around a tube do. Same bits for any number of workers.
std::vector<Sphere> shrunken_balls(const SignedDistance& shape, std::span<const Vec3> points,
                                   std::span<const Vec3> normals, BallSharing sharing,
                                   Workers& workers = serial_workers());

}  // namespace morula::detail
