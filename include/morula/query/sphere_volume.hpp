// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Volume of a ball inside and outside an object, exactly.
#pragma once

#include <morula/query/signed_distance.hpp>

namespace morula {

/// Volume of ball ∩ object by summing, over the facets that meet the ball, the signed volume of ball ∩ cone(center,
/// facet) in closed form; the far facets count through their total solid angle.
///
/// The mesh must be closed and oriented. Then the error is about 1e-12 of the ball's volume wherever the center lies,
/// on edges and vertices too, and as long as the ball is not smaller than the spacing of its coordinates. Of an open
/// mesh it is the integral of the winding number, to about a percent of the ball. Where layers overlap, each counts,
/// up to the whole ball. Throws std::invalid_argument for balls with numbers beyond 2^100. Cost: O(k + log F), k facets
/// met.
double inside_volume(const SignedDistance& object, const Sphere& ball);

/// Volume of ball minus object: the sphere outside volume [wang2006].
double outside_volume(const SignedDistance& object, const Sphere& ball);

}  // namespace morula
