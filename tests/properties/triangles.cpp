// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "triangles.hpp"

#include <vector>

namespace oracle {
namespace {

__extension__ using Integer = __int128;

// Calls separates(axis) for directions among which is one that separates the two, if any does.
//
// The difference of two triangles is a polytope, and the triangles are apart when the origin is outside of it. Where it
// is solid, its sides are parallel to two edges of the two. Where it is flat, all edges are in a plane: its normal is a
// product of two edges, and its sides in the plane are parallel to edges. Where it is a segment: along the edges, or
// across them towards the other triangle. A point: towards it. Directions too many do no harm.
template <class V, class Separates>
bool some_axis(const std::array<V, 3>& a, const std::array<V, 3>& b, const Separates& separates) {
  std::array<V, 6> edges;
  for (std::size_t k = 0; k < 3; ++k) {
    edges[k] = a[(k + 1) % 3] - a[k];
    edges[k + 3] = b[(k + 1) % 3] - b[k];
  }
  const V across = a[0] - b[0];
  for (const V& axis : {V{1, 0, 0}, V{0, 1, 0}, V{0, 0, 1}, across})
    if (separates(axis)) return true;
  for (const V& e : edges) {
    if (separates(e)) return true;
    if (separates(dot(e, e) * across - dot(across, e) * e)) return true;
  }
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i + 1; j < 6; ++j) {
      const V normal = cross(edges[i], edges[j]);
      if (separates(normal)) return true;
    }
  for (std::size_t i = 0; i < 6; ++i)
    for (std::size_t j = i + 1; j < 6; ++j) {
      const V normal = cross(edges[i], edges[j]);
      if (dot(normal, normal) == 0) continue;
      for (const V& e : edges)
        if (separates(cross(normal, e))) return true;
    }
  return false;
}

template <class V>
auto gap_along(const V& axis, const std::array<V, 3>& a, const std::array<V, 3>& b) {
  const auto [a_low, a_high] = std::minmax({dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2])});
  const auto [b_low, b_high] = std::minmax({dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2])});
  return std::max(b_low - a_high, a_low - b_high);
}

std::optional<Point> pierced(const Point& p, const Point& q, const Triangle& t, Real margin) {
  const Point normal = cross(t[1] - t[0], t[2] - t[0]);
  const Real length = std::sqrt(dot(normal, normal));
  if (!(length > 0)) return std::nullopt;
  const Real above = dot(normal, p - t[0]) / length, below = dot(normal, q - t[0]) / length;
  if (std::min(std::abs(above), std::abs(below)) <= margin || (above > 0) == (below > 0)) return std::nullopt;
  const Point x = p + (above / (above - below)) * (q - p);
  for (std::size_t k = 0; k < 3; ++k) {
    const Point edge = t[(k + 1) % 3] - t[k];
    const Point inward = cross(normal, edge);
    if (!(dot(inward, x - t[k]) > margin * std::sqrt(dot(inward, inward)))) return std::nullopt;
  }
  return x;
}

}  // namespace

bool meet_exactly(const LatticeTriangle& a, const LatticeTriangle& b) {
  // Edges have 21 bits, normals 43, sides in a plane 66, projections 89 and a few.
  using Wide = Vector<Integer>;
  const auto widened = [](const LatticeTriangle& t) {
    std::array<Wide, 3> wide;
    for (std::size_t k = 0; k < 3; ++k) wide[k] = {t[k].x, t[k].y, t[k].z};
    return wide;
  };
  const std::array<Wide, 3> wide_a = widened(a), wide_b = widened(b);
  return !some_axis(wide_a, wide_b, [&](const Wide& axis) { return gap_along(axis, wide_a, wide_b) > 0; });
}

bool clearly_apart(const Triangle& a, const Triangle& b, Real margin) {
  return some_axis(a, b, [&](const Point& axis) {
    const Real length = std::sqrt(dot(axis, axis));
    return length > 0 && gap_along(axis, a, b) > margin * length;
  });
}

std::optional<Point> clearly_crossing(const Triangle& a, const Triangle& b, Real margin) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (const auto x = pierced(a[k], a[(k + 1) % 3], b, margin)) return x;
    if (const auto x = pierced(b[k], b[(k + 1) % 3], a, margin)) return x;
  }
  return std::nullopt;
}

}  // namespace oracle
