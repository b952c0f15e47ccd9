// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Points of features at rest, which prove for eight features against eight others that they are near at rest.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "surface/boxes/feature_boxes.hpp"

namespace morula::detail {

/// Eight points side by side, about the surface's origin. Unused places hold NaN, which is near nothing.
struct alignas(32) PointGroup {
  float at[3][8];
};

/// Bit 8 i + j: the squared distance of point i of a and point j of b, computed in floats, is at most `squared`. All
/// kinds of processors compute the same bits.
using NearPoints = std::uint64_t (*)(const PointGroup& a, const PointGroup& b, float squared);
/// The kernels that this processor runs, the narrowest first.
std::span<const NearPoints> all_near_points();

/// A point of each feature at rest, in the groups of FeatureBoxes: the middle of its vertices.
class RestPoints {
 public:
  /// No points.
  RestPoints() = default;
  /// rest_distance: a length above 0. rounding: the allowance of ExclusionTest.
  RestPoints(const SurfaceTreeState& s, double rest_distance, double rounding, Features features);
  /// Whether it can prove of any pair that it is near.
  bool are_made() const { return squared_ > 0; }
  std::size_t bytes() const;

  const PointGroup* facets(std::uint32_t block) const { return groups_.data() + first_[block]; }
  const PointGroup* vertices(std::uint32_t block) const { return facets(block) + 1; }
  /// One past the end for a last block without edges.
  const PointGroup* edges(std::uint32_t block) const { return groups_.data() + first_edges_[block]; }
  /// Bit 8 i + j: features i and j are surely at most rest_distance apart at rest.
  std::uint64_t are_near(const PointGroup& a, const PointGroup& b) const { return near_points_(a, b, squared_); }

 private:
  float squared_ = 0;
  NearPoints near_points_ = nullptr;
  std::vector<PointGroup> groups_;
  std::vector<std::uint32_t> first_, first_edges_;  // by block
};

}  // namespace morula::detail
