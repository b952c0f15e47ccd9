// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres in few decimals, as in files, for which the proofs still hold.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

namespace morula::robot {

/// The largest motion of a sphere's surface when its numbers are read as float, for spheres that lie within `extent` of
/// the origin along each axis.
double float_allowance(double extent);
/// Largest |coordinate| of a point of the spheres.
double extent_of(std::span<const Sphere> spheres);

/// Spheres in few decimals that contain the given ones, also when their numbers are read as float: the largest motion
/// by rounding is added to the radius.
void round_outward(std::vector<Sphere>& spheres);
/// The same inside the given ones. Spheres without a positive radius after that are removed.
void round_inward(std::vector<Sphere>& spheres);

}  // namespace morula::robot
