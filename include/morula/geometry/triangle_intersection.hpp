// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Intersection of two triangles: an exact test, and the common points.
#pragma once

#include <morula/geometry/triangle.hpp>
#include <optional>

namespace morula {

/// A segment; both ends may be one point.
struct Segment {
  Vec3 from, to;
  constexpr bool operator==(const Segment&) const = default;
};

/// True if the two closed triangles have a common point. Exact for all finite doubles, however small, large or close: a
/// common vertex, a vertex on an edge and an overlap of coplanar triangles count. Triangles without area are the
/// segments or points that they degenerate to. The result is the same for (b, a) and for any order of corners.
/// Cost: 25 to 45 ns if separate, 75 ns if crossing [guigue2003], 1.5 µs if coplanar.
bool intersect(const Triangle& a, const Triangle& b);

/// The common points; no value exactly if intersect() is false. Ends are rounded: each is a corner or lies, up to
/// rounding, on an edge of one triangle. If coplanar triangles share an area, their common points are a polygon; the
/// result is its longest diagonal, between two of its corners. Cost: up to twice that of intersect().
std::optional<Segment> intersection(const Triangle& a, const Triangle& b);

}  // namespace morula
