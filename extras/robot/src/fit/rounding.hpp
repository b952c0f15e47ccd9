// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres in few decimals, as files hold them, without losing what was proven of them.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

namespace morula::robot {

/// What a sphere's surface moves by at most when its numbers are read as float, for spheres that lie within `extent` of
/// the origin along each axis.
double float_allowance(double extent);
/// Largest |coordinate| of a point of the spheres.
double extent_of(std::span<const Sphere> spheres);

/// Spheres in few decimals that contain the given ones, also when their numbers are read as float: what rounding may
/// move is added to the radius.
void round_outward(std::vector<Sphere>& spheres);
/// The same inside the given ones. Those of which nothing would be left go.
void round_inward(std::vector<Sphere>& spheres);

}  // namespace morula::robot
