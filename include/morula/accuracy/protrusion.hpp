// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Protrusion: how far spheres stick out of the object, in the sense of Hubbard's Hausdorff measure.
#pragma once

#include <morula/query/signed_distance.hpp>
#include <span>

namespace morula {

/// Largest distance from a point of the ball to the object: max over the ball of φ⁺, cavities included.
struct BallProtrusion {
  double lower;  ///< attained
  double upper;  ///< proven; upper − lower ≤ tolerance × radius
};
/// Branch and bound on the octree of the ball's cube, started from directions on the sphere. The object must tell
/// inside from outside (a closed, oriented mesh). tolerance: positive, share of the radius; never finer than 2⁻⁴⁶ of
/// the largest coordinate. Cost: a few distances where the nearest surface goes on straight, as on convex objects; else
/// about 1/tolerance. Throws std::invalid_argument for a bad ball or tolerance.
BallProtrusion protrusion(const SignedDistance& object, const Sphere& ball, double tolerance = 1e-3);

struct Protrusion {
  double worst = 0;  ///< over the spheres, upper ends; mesh units
  double mean = 0;
};
/// Same bits for any number of workers.
Protrusion protrusion(const SignedDistance& object, std::span<const Sphere> spheres, double tolerance = 1e-2,
                      WorkersOrAll workers = {});

}  // namespace morula
