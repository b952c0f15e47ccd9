// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "accuracy/bare_polygon.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/reproducible.hpp>

namespace morula::detail {
namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x * b.y - a.y * b.x;
}
double dot(const Vec2& a, const Vec2& b) {
  return a.x * b.x + a.y * b.y;
}

// Triangle (origin, a, b) less the disc's sector between the same rays, for a segment that lies outside the disc.
double triangle_less_sector(const Vec2& a, const Vec2& b, double radius) {
  const double twice_triangle = cross(a, b);
  return 0.5 * (twice_triangle - radius * radius * angle_of(twice_triangle, dot(a, b)));
}

}  // namespace

double area_outside_disc(std::span<const Vec2> polygon, double radius) {
  // Green's theorem about the disc's center: a piece of border inside the disc adds a triangle to the polygon's area
  // and the same triangle to the area covered, so only pieces outside remain.
  double sum = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2 a = polygon[k], b = polygon[(k + 1) % polygon.size()];
    const Vec2 along{b.x - a.x, b.y - a.y};
    const double length = std::sqrt(dot(along, along));
    if (length == 0) continue;
    const double height = std::abs(cross(a, along)) / length;
    if (height >= radius) {
      sum += triangle_less_sector(a, b, radius);
      continue;
    }
    const double half_chord = std::sqrt((radius - height) * (radius + height));
    const double foot = -dot(a, along) / length;
    const double enters = (foot - half_chord) / length, leaves = (foot + half_chord) / length;
    const auto at = [&](double t) { return Vec2{a.x + t * along.x, a.y + t * along.y}; };
    if (enters >= 1 || leaves <= 0) {
      sum += triangle_less_sector(a, b, radius);
      continue;
    }
    if (enters > 0) sum += triangle_less_sector(a, at(enters), radius);
    if (leaves < 1) sum += triangle_less_sector(at(leaves), b, radius);
  }
  return std::max(0.0, sum);
}

FacetPlane::FacetPlane(const Triangle& facet) {
  const std::array<Vec3, 3> edges{facet[1] - facet[0], facet[2] - facet[1], facet[0] - facet[2]};
  const auto longest = std::max_element(
      edges.begin(), edges.end(), [](const Vec3& a, const Vec3& b) { return squared_length(a) < squared_length(b); });
  first = normalized(*longest);
  normal = normalized(area_vector(facet));
  second = morula::cross(normal, first);
}

double area_outside_sphere(const FacetPlane& plane, std::span<const Vec3> polygon, const Sphere& sphere,
                           std::vector<Vec2>& scratch) {
  // From the sphere's center, so that far from the origin nothing cancels. A corner's own height differs from the
  // plane's by rounding alone; the first will do.
  const double height = morula::dot(polygon[0] - sphere.center, plane.normal);
  scratch.clear();
  for (const Vec3& p : polygon) {
    const Vec3 from_center = p - sphere.center;
    scratch.push_back({morula::dot(from_center, plane.first), morula::dot(from_center, plane.second)});
  }
  const double squared = (sphere.radius - height) * (sphere.radius + height);
  return area_outside_disc(scratch, squared > 0 ? std::sqrt(squared) : 0.0);
}

}  // namespace morula::detail
