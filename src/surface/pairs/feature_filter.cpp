// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/feature_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace morula::detail {
namespace {

bool fits(const FacetMasks& masks, const SurfaceTreeState& s) {
  const auto fits_one = [&](const std::vector<std::uint32_t>& mask) {
    return mask.empty() || mask.size() == s.facets.size();
  };
  return fits_one(masks.category) && fits_one(masks.mask);
}

void gather(std::span<const std::uint32_t> facet_bits, const SurfaceTreeState& s, std::vector<std::uint32_t>& vertices,
            std::vector<std::uint32_t>& edges) {
  vertices.assign(s.rest.size(), 0);
  edges.assign(s.edges.size(), 0);
  for (std::size_t f = 0; f < s.facets.size(); ++f) {
    const Facet& facet = s.facets[f];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = facet[k], w = facet[(k + 1) % 3];
      vertices[v] |= facet_bits[f];
      if (v == w) continue;
      const std::array<std::uint32_t, 2> ends{std::min(v, w), std::max(v, w)};
      edges[static_cast<std::size_t>(std::lower_bound(s.edges.begin(), s.edges.end(), ends) - s.edges.begin())] |=
          facet_bits[f];
    }
  }
}

}  // namespace

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
                            Features features, Workers& workers) {
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
  tests_each_ = excluded_ != nullptr && !excluded_->is_kept();
  const bool within = is_one && (filter.same_component || tests_each_);
  keeps_all_ = !within && !masks_a_.are_given() && !masks_b_.are_given() && !filter.accepts;
  return {};
}

bool FeatureFilter::keeps_one(const FeaturePair& pair) const {
  const Feature of_a = feature_a(pair.kind), of_b = feature_b(pair.kind);
  if (b_ == a_) {
    const FeatureVertices in_a(*a_, of_a, pair.a), in_b(*a_, of_b, pair.b);
    if (filter_->same_component && a_->component[in_a[0]] == a_->component[in_b[0]]) return false;
    if (tests_each_ && ExclusionTest(*a_, excluded_->rule()).excludes(pair)) return false;
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
