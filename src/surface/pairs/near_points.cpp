// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/pairs/near_points.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "simd/float4.hpp"
#include "simd/processors.hpp"

namespace morula::detail {
namespace {

/// The reference: all other kernels have to return the same bits.
namespace plain {

std::uint64_t near_of(const PointGroup& a, const PointGroup& b, float squared) {
  std::uint64_t bits = 0;
  for (int i = 0; i < 8; ++i)
    for (int j = 0; j < 8; ++j) {
      const float x = b.at[0][j] - a.at[0][i], y = b.at[1][j] - a.at[1][i], z = b.at[2][j] - a.at[2][i];
      bits |= std::uint64_t{x * x + y * y + z * z <= squared} << (8 * i + j);
    }
  return bits;
}

}  // namespace plain

#define MORULA_KERNELS "surface/pairs/near_points.inl"
#include "simd/every_processor.inl"

constexpr KernelTable<NearPoints> near_points_table{MORULA_EVERY_KIND(near_of)};

/// The largest squared distance of points, as computed in floats, at which features are surely near; 0: never.
///
/// Claim: two features whose points have a computed squared distance of at most this number are at most rest_distance -
/// rounding apart at rest, which excludes the pair (ExclusionTest).
///
/// Proof. Let R be the largest |coordinate| at rest and r the rest distance. A point is the middle of a feature's
/// vertices, computed in doubles: it is off a point of the feature by less than 2^-49 R. Coordinates about the origin
/// are below 2 R, so floats of them are off by 2^-23 R, a difference of two by 2^-22 R, and by another 2^-22 R when it
/// is rounded: the vector between the points is off by less than 2^-20 R. Squares and sums are off by 2^-22 of the
/// computed square; those that underflow by 2^-124, which is 2^-24 of it at the limit below. So features with a
/// computed square of at most n^2, n = r - rounding - pad, rounded to a float, are at most n (1 + 2^-21) + 2^-19.9 R
/// apart, which is below n + pad.
float squared_limit(double rest_distance, double rounding, double rest_reach) {
  // mutant rest-points-pad: `0x1p-19` -> `0`
  const double pad = 0x1p-19 * (rest_reach + rest_distance);
  const double near = rest_distance - rounding - pad;
  constexpr double least = 0x1p-50, most = 0x1p60;  // squares of them are far from the ends of float
  if (!(near > least) || !(rest_reach < most)) return 0;
  // Points are never as far apart as the largest number.
  return static_cast<float>(std::min(near, 4 * most) * std::min(near, 4 * most));
}

}  // namespace

std::span<const NearPoints> all_near_points() {
  return near_points_table.runnable();
}

RestPoints::RestPoints(const SurfaceTreeState& s, double rest_distance, double rounding, Features features)
    : squared_(squared_limit(rest_distance, rounding, s.rest_reach)), near_points_(near_points_table.widest()) {
  if (!are_made()) return;
  std::size_t place = 8;
  const auto begin = [&] { place = 8; };
  const auto add = [&](const auto& vertices) {
    if (place == 8) {
      PointGroup& group = groups_.emplace_back();
      for (auto& axis : group.at) std::fill(std::begin(axis), std::end(axis), std::numeric_limits<float>::quiet_NaN());
      place = 0;
    }
    Vec3 sum{};
    for (const std::uint32_t v : vertices) sum += s.mesh.rest[v];
    const Vec3 middle = sum / static_cast<double>(vertices.size()) - s.origin;
    for (int k = 0; k < 3; ++k) groups_.back().at[k][place] = static_cast<float>(middle[k]);
    ++place;
  };
  for (std::uint32_t block = 0; block < s.block_count(); ++block) {
    first_.push_back(static_cast<std::uint32_t>(groups_.size()));
    begin();
    for (std::size_t i = 8 * std::size_t{block}; i < std::min(s.blocks.order.size(), 8 * std::size_t{block} + 8); ++i)
      add(s.blocks.facets_in_order[i]);
    if (features == Features::facets) continue;
    begin();
    for (std::uint32_t i = s.blocks.own_vertices[block]; i < s.blocks.own_vertices[block + 1]; ++i)
      add(std::array{s.blocks.vertex_of_slot[i]});
    first_edges_.push_back(static_cast<std::uint32_t>(groups_.size()));
    begin();
    for (std::uint32_t i = s.blocks.own_edges_begin[block]; i < s.blocks.own_edges_begin[block + 1]; ++i)
      add(s.blocks.ends_of_own_edges[i]);
  }
}

std::size_t RestPoints::bytes() const {
  return groups_.size() * sizeof(PointGroup) + (first_.size() + first_edges_.size()) * sizeof(std::uint32_t);
}

}  // namespace morula::detail
