// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/feature_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <morula/geometry/box.hpp>
#include <morula/geometry/scale.hpp>
#include <stdexcept>
#include <string>

#include "geometry/nearest_pair.hpp"

namespace morula::detail {
namespace {

double length_of(const Vec3& v) {
  const double square = squared_length(v);
  return square > 0x1p-900 && square < 0x1p900 ? std::sqrt(square) : scaled_length(v);
}

bool fits(const FacetMasks& masks, const SurfaceTreeState& s) {
  const auto fits_one = [&](const std::vector<std::uint32_t>& mask) {
    return mask.empty() || mask.size() == s.mesh.facets.size();
  };
  return fits_one(masks.category) && fits_one(masks.mask);
}

void gather(std::span<const std::uint32_t> facet_bits, const SurfaceTreeState& s, std::vector<std::uint32_t>& vertices,
            std::vector<std::uint32_t>& edges) {
  vertices.assign(s.mesh.rest.size(), 0);
  edges.assign(s.mesh.edges.size(), 0);
  for (std::size_t f = 0; f < s.mesh.facets.size(); ++f) {
    const Facet& facet = s.mesh.facets[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = facet[k], w = facet[(k + 1) % 3];
      vertices[v] |= facet_bits[f];
      if (v == w) continue;
      const std::array<std::uint32_t, 2> ends{std::min(v, w), std::max(v, w)};
      edges[static_cast<std::size_t>(std::lower_bound(s.mesh.edges.begin(), s.mesh.edges.end(), ends) -
                                     s.mesh.edges.begin())] |= facet_bits[f];
    }
  }
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
  for (std::size_t i = 0; i < in_a.size(); ++i) a[i] = s.mesh.rest[in_a[i]];
  for (std::size_t i = 0; i < in_b.size(); ++i) b[i] = s.mesh.rest[in_b[i]];
  if (pair.kind == PairKind::facet_facet) return are_within(a, b, distance);
  return nearest_points(pair, std::span(a).first(in_a.size()), std::span(b).first(in_b.size())).distance <= distance;
}

// Features are no farther apart than two of their vertices, and no nearer than their boxes. The allowance of the test
// exceeds the error of both lengths, so this is the same as are_within_at_rest().
bool RestTest::is_near(const SurfaceTreeState& s, const FeaturePair& pair) const {
  const FeatureVertices in_a(s, feature_a(pair.kind), pair.a), in_b(s, feature_b(pair.kind), pair.b);
  Box box_a, box_b;
  for (const std::uint32_t v : in_a) box_a.add(s.mesh.rest[v]);
  for (const std::uint32_t w : in_b) box_b.add(s.mesh.rest[w]);
  const Vec3 gap = max(max(box_a.lower - box_b.upper, box_b.lower - box_a.upper), Vec3{});
  if (squared_length(gap) > surely_apart_) return false;
  for (const std::uint32_t w : in_b)
    for (const std::uint32_t v : in_a)
      if (squared_length(s.mesh.rest[v] - s.mesh.rest[w]) <= surely_near_) return true;
  return are_within_at_rest(s, pair, distance_);
}

RestTest::RestTest(double distance, double rounding) : distance_(distance) {
  // Squares that underflow or overflow decide nothing.
  const double near = distance - rounding, apart = distance + rounding;
  if (near > 0x1p-450) surely_near_ = near * near * (1 - 0x1p-50);
  if (apart > 0x1p-450 && apart < 0x1p450) surely_apart_ = apart * apart * (1 + 0x1p-50);
}

void FeatureFilter::require_usable(const PairFilter& filter) {
  if (!(filter.rest_distance >= 0) || !std::isfinite(filter.rest_distance))
    throw std::invalid_argument("PairFilter::rest_distance " + std::to_string(filter.rest_distance) +
                                " is not a length of 0 or more");
}

void FeatureFilter::Masks::start(const FacetMasks& masks, const SurfaceTreeState& s) {
  facet_category = masks.category, facet_mask = masks.mask;
  if (!facet_category.empty()) gather(facet_category, s, vertex_of, edge_of);
  if (!facet_mask.empty()) gather(facet_mask, s, vertex_with, edge_with);
}

std::uint32_t FeatureFilter::Masks::of(Feature feature, std::uint32_t number) const {
  if (facet_category.empty()) return 0xffffffffu;
  return feature == Feature::vertex ? vertex_of[number]
         : feature == Feature::edge ? edge_of[number]
                                    : facet_category[number];
}

std::uint32_t FeatureFilter::Masks::with(Feature feature, std::uint32_t number) const {
  if (facet_mask.empty()) return 0xffffffffu;
  return feature == Feature::vertex ? vertex_with[number]
         : feature == Feature::edge ? edge_with[number]
                                    : facet_mask[number];
}

Status FeatureFilter::start(const PairFilter& filter, const SurfaceTreeState& a, const SurfaceTreeState& b,
                            Features features, bool makes_table, Workers& workers) {
  if (!fits(filter.masks_a, a)) return {.code = Status::Code::bad_option};
  const bool is_one = &a == &b;
  if (!is_one && !fits(filter.masks_b, b)) return {.code = Status::Code::bad_option, .body = 1};
  filter_ = &filter;
  a_ = &a, b_ = &b;
  masks_a_.start(filter.masks_a, a);
  if (is_one)
    masks_b_ = masks_a_;
  else
    masks_b_.start(filter.masks_b, b);
  const ExclusionRule rule{filter.rings, filter.rest_distance, features};
  excluded_ = is_one && rule.excludes_any() ? excluded_pairs(a, rule, workers) : nullptr;
  if (excluded_ != nullptr && makes_table) excluded_->make_table(workers);
  rest_test_ = RestTest(rule.rest_distance, ExclusionTest(a, rule).rounding());
  tests_rest_ = excluded_ != nullptr && rule.rest_distance > 0;
  const bool within = is_one && (filter.same_component || tests_rest_);
  accepts_all_ = !within && !masks_a_.are_given() && !masks_b_.are_given() && !filter.accepts;
  return {};
}

bool FeatureFilter::accepts_one(const FeaturePair& pair, bool are_neighbors_known) const {
  const Feature of_a = feature_a(pair.kind), of_b = feature_b(pair.kind);
  if (b_ == a_) {
    const FeatureVertices in_a(*a_, of_a, pair.a), in_b(*a_, of_b, pair.b);
    if (filter_->same_component && a_->mesh.component[in_a[0]] == a_->mesh.component[in_b[0]]) return false;
    if (tests_rest_ && rest_test_.is_near(*a_, pair)) return false;
    if (!are_neighbors_known && ExclusionTest(*a_, excluded_->rule()).are_neighbors(pair)) return false;
  }
  if ((masks_a_.are_given() || masks_b_.are_given()) &&
      // mutant feature-mask-there: `(masks_a_.of(of_a, pair.a) & masks_b_.with(of_b, pair.b)) == 0` -> `false`
      ((masks_a_.of(of_a, pair.a) & masks_b_.with(of_b, pair.b)) == 0 ||
       // mutant feature-mask-back: `(masks_b_.of(of_b, pair.b) & masks_a_.with(of_a, pair.a)) == 0` -> `false`
       (masks_b_.of(of_b, pair.b) & masks_a_.with(of_a, pair.a)) == 0))
    return false;
  return !filter_->accepts || filter_->accepts(pair);
}

}  // namespace morula::detail
