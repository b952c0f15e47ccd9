// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <map>
#include <morula/collide/convex_hull.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <morula/geometry/scale.hpp>
#include <stdexcept>
#include <string>

#include "geometry/exact_predicates.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

/// Whether a, b and c are on one line, exactly.
bool are_on_a_line(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::all_of(std::begin(projections), std::end(projections),
                     [&](Projection p) { return orient2d(a, b, c, p) == 0; });
}

/// Four points that span space, the first three clockwise seen from the fourth.
std::array<std::uint32_t, 4> first_four(std::span<const Vec3> points) {
  const auto count = static_cast<std::uint32_t>(points.size());
  std::uint32_t b = 1;
  while (b < count && points[b] == points[0]) ++b;
  std::uint32_t c = b + 1;
  while (c < count && are_on_a_line(points[0], points[b], points[c])) ++c;
  for (std::uint32_t d = c + 1; d < count; ++d) {
    const int side = orient3d(points[0], points[b], points[c], points[d]);
    if (side < 0) return {0, b, c, d};
    if (side > 0) return {0, c, b, d};
  }
  throw std::invalid_argument("all " + std::to_string(count) +
                              " points of a hull lie in one plane: it needs four that do not");
}

/// The hull grows point by point: new facets between the point and the border of the facets that see it strictly
/// replace those facets.
///
/// A facet in whose plane the point lies counts as not seen. The seen facets still form one region without holes,
/// because a point a little nearer to the middle of the hull sees the same facets and is in no plane of the others. And
/// the point is on no line of an edge of the border, since one of the two facets there sees it strictly; so no facet is
/// flat.
std::vector<Facet> facets_around(std::span<const Vec3> points) {
  const auto [a, b, c, d] = first_four(points);
  std::vector<Facet> facets{{a, b, c}, {a, d, b}, {b, d, c}, {c, d, a}}, kept;
  std::map<std::array<std::uint32_t, 2>, bool> seen;  // sides of facets that see the point
  InterruptPoller poll_interrupt(64);
  for (std::uint32_t p = 1; p < points.size(); ++p) {
    if (p == b || p == c || p == d) continue;
    poll_interrupt();
    kept.clear();
    seen.clear();
    for (const Facet& f : facets) {
      if (orient3d(points[f[0]], points[f[1]], points[f[2]], points[p]) <= 0) {
        kept.push_back(f);
        continue;
      }
      for (std::size_t k = 0; k < 3; ++k) seen[{f[k], f[(k + 1) % 3]}] = true;
    }
    for (const auto& [side, is_seen] : seen)
      if (!seen.contains({side[1], side[0]})) kept.push_back({side[0], side[1], p});
    facets.swap(kept);
  }
  return facets;
}

void require_near(std::span<const Vec3> points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points[i]) || !(max_norm(points[i]) < greatest_usable_scale))
      throw std::invalid_argument("point " + std::to_string(i) +
                                  " of a hull is not finite, or 2^100 or more from the origin");
}

}  // namespace

ConvexHull::ConvexHull(std::span<const Vec3> points) {
  const StandardFloats standard;
  require_near(points);
  if (points.size() < 4)
    throw std::invalid_argument("a hull needs four points that do not lie in one plane, not " +
                                std::to_string(points.size()));
  facets_ = facets_around(points);
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(points.size(), none);
  for (const Facet& f : facets_)
    for (const std::uint32_t v : f) number[v] = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (number[v] == none) continue;
    number[v] = static_cast<std::uint32_t>(vertices_.size());
    vertices_.push_back(points[v]);
  }
  for (Facet& f : facets_)
    for (std::uint32_t& v : f) v = number[v];
  measure();
}

ConvexHull ConvexHull::box(const Box& box, const RigidTransform& transform) {
  const StandardFloats standard;
  std::array<Vec3, 8> corners;
  for (std::size_t k = 0; k < 8; ++k)
    corners[k] = {(k & 1 ? box.upper : box.lower).x, (k & 2 ? box.upper : box.lower).y,
                  (k & 4 ? box.upper : box.lower).z};
  const Vec3 extent = box.extent();
  if (!(extent.x > 0 && extent.y > 0 && extent.z > 0))
    throw std::invalid_argument("a box that is empty or flat is no hull");
  return ConvexHull(corners).placed(transform);
}

ConvexHull ConvexHull::placed(const RigidTransform& transform) const {
  const StandardFloats standard;
  const RigidTransform rigid = rigid_or_throw(transform, "the transform of a hull");
  ConvexHull hull = *this;
  for (Vec3& p : hull.vertices_) p = rigid(p);
  require_near(hull.vertices_);
  hull.measure();
  return hull;
}

// The offset of a plane is that of the farthest vertex, so that the hull is behind the plane, whatever rounding did to
// the normal of a narrow facet.
void ConvexHull::measure() {
  largest_ = 0;
  for (const Vec3& p : vertices_) largest_ = std::max(largest_, max_norm(p));
  planes_.resize(facets_.size());
  InterruptPoller poll_interrupt(64);
  for (std::size_t f = 0; f < facets_.size(); ++f) {
    poll_interrupt();
    const Vec3 &a = vertices_[facets_[f][0]], &b = vertices_[facets_[f][1]], &c = vertices_[facets_[f][2]];
    const double size = std::max(max_norm(b - a), max_norm(c - a));
    const Vec3 normal = normalized(cross((b - a) / size, (c - a) / size));
    double offset = dot(normal, a);
    for (const Vec3& p : vertices_) offset = std::max(offset, dot(normal, p));
    planes_[f] = {normal, offset};
  }
}

}  // namespace morula
