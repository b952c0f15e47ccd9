// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Volume of a ball inside and outside an object, exactly.
#pragma once

#include <morula/query/signed_distance.hpp>

namespace morula {

/// Volume of ball ∩ object by summing, over the facets that meet the ball, the signed volume of ball ∩ cone(centre,
/// facet) in closed form; the far facets count through their total solid angle (ALGORITHMS A.5, J.8).
///
/// The mesh must be closed and oriented. Error: about 1e-10 of the ball's volume. Cost: O(k + log F), k facets met.
double inside_volume(const SignedDistance& object, const Sphere& ball);

/// Volume of ball minus object: the sphere outside volume [wang2006].
double outside_volume(const SignedDistance& object, const Sphere& ball);

}  // namespace morula
