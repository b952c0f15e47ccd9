// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sphere fit: one sphere around the points that it must contain, with the center where it sticks out least.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <morula/query/signed_distance.hpp>
#include <span>

namespace morula::detail {

/// Searches a center c that makes r(c) + φ(c), the bound of the sphere's protrusion, small; r(c) is the farthest
/// point's distance and φ the signed distance to the object. The search starts from the better of `start` and the
/// smallest sphere's center. Returns the exact radius max |x − c|, without pad. Cost: about forty evaluations, each
/// over a few hundred extreme points and one closest-point query.
Sphere recenter(std::span<const Vec3> points, const Vec3& start, const SignedDistance& shape);

}  // namespace morula::detail
