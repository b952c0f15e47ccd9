// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bare area of a flat polygon: the part outside a sphere, in closed form.
#pragma once

#include <array>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <span>
#include <vector>

namespace morula::detail {

struct Vec2 {
  double x, y;
};

/// Area of a convex polygon (counter-clockwise) outside the disc about the origin. Error: a few ulps of the triangles
/// between the origin and those parts of the border that lie outside the disc; what lies inside cancels exactly.
double area_outside_disc(std::span<const Vec2> polygon, double radius);

/// Axes in the plane of a facet that has an area.
struct FacetPlane {
  explicit FacetPlane(const Triangle& facet);

  Vec3 first, second, normal;
};

/// Area of the part of a convex polygon in that plane, counter-clockwise about its normal, that lies outside the
/// sphere. scratch: anything.
double area_outside_sphere(const FacetPlane& plane, std::span<const Vec3> polygon, const Sphere& sphere,
                           std::vector<Vec2>& scratch);

}  // namespace morula::detail
