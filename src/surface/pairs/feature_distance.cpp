// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/feature_distance.hpp"

#include <cmath>
#include <morula/geometry/scale.hpp>

#include "geometry/nearest_pair.hpp"
#include "surface/pairs/feature_filter.hpp"

namespace morula::detail {
namespace {

double length_of(const Vec3& v) {
  const double square = squared_length(v);
  return square > 0x1p-900 && square < 0x1p900 ? std::sqrt(square) : scaled_length(v);
}

}  // namespace

ProximityPair nearest_points(const FeaturePair& pair, std::span<const Vec3> a, std::span<const Vec3> b) {
  ProximityPair found{pair};
  if (a.size() == 2) {
    const Vec3 d = a[1] - a[0], e = b[1] - b[0];
    const auto [s, t] = nearest_on_segments(a[0], d, b[0], e);
    const auto at = [](std::span<const Vec3> ends, const Vec3& way, double u) {
      return u == 0 ? ends[0] : u == 1 ? ends[1] : ends[0] + way * u;
    };
    found.weights_a = {1 - s, s, 0}, found.weights_b = {1 - t, t, 0};
    found.point_a = at(a, d, s), found.point_b = at(b, e, t);
  } else {
    const bool vertex_first = a.size() == 1;
    const std::span<const Vec3> corners = vertex_first ? b : a;
    const Vec3& p = vertex_first ? a[0] : b[0];
    const TrianglePoint nearest = closest_point({corners[0], corners[1], corners[2]}, p);
    found.weights_a = found.weights_b = {1, 0, 0};
    (vertex_first ? found.weights_b : found.weights_a) = nearest.barycentric;
    found.point_a = vertex_first ? p : nearest.point, found.point_b = vertex_first ? nearest.point : p;
  }
  found.distance = length_of(found.point_b - found.point_a);
  return found;
}

bool are_within_at_rest(const SurfaceTreeState& s, const FeaturePair& pair, double distance) {
  std::array<Vec3, 3> a, b;
  const FeatureVertices in_a(s, feature_a(pair.kind), pair.a), in_b(s, feature_b(pair.kind), pair.b);
  for (std::size_t i = 0; i < in_a.size(); ++i) a[i] = s.rest[in_a[i]];
  for (std::size_t i = 0; i < in_b.size(); ++i) b[i] = s.rest[in_b[i]];
  if (pair.kind == PairKind::facet_facet) return are_within(a, b, distance);
  return nearest_points(pair, std::span(a).first(in_a.size()), std::span(b).first(in_b.size())).distance <= distance;
}

}  // namespace morula::detail
