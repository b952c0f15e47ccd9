// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Nearest points of two triangles, or of a segment or a point and a triangle, with bounds that hold in real numbers.
#pragma once

#include <morula/geometry/triangle.hpp>
#include <span>

namespace morula::detail {

struct NearestPair {
  Barycentric a{}, b{};
  Vec3 point_a{}, point_b{};
  /// lower <= distance of the two shapes <= upper, for exact corners. 0 and 0 exactly when `crossing`.
  double lower = 0, upper = 0;
  /// Whether the two have a common point, decided exactly, also for touching and coplanar ones.
  bool crossing = false;
};

/// a: the corners of a point, a segment or a triangle: 1, 2 or 3 of them.
///
/// The result is the pair of features that is nearest by computed distance, the first of equals [ericson2005, 5.1.9,
/// 5.1.10]. upper is the distance of the points found, rounded up; lower the width of a slab between the shapes, along
/// the line through them or, if that is loose, along directions of the features, rounded down: so both bounds hold for
/// any choice of features.
NearestPair nearest_pair(std::span<const Vec3> a, const Triangle& b);

/// Whether nearest_pair(a, b).upper <= distance, decided faster. distance: 0 or more.
bool are_within(const Triangle& a, const Triangle& b, double distance);

/// Width of the slab along `direction` (from a to b, any length but 0) that has all of a on one side and all of b on
/// the other; negative when there is none. Rounded down.
double slab_width(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& from, const Vec3& direction);

struct SegmentParameters {
  double s, t;
};
/// Nearest points p + s d and q + t e of two segments, s and t from 0 to 1 [ericson2005, 5.1.9].
SegmentParameters nearest_on_segments(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e);

/// Parameter of the point of [p, q] nearest to x.
double nearest_parameter(const Vec3& p, const Vec3& q, const Vec3& x);

}  // namespace morula::detail
