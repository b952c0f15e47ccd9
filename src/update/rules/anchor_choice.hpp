// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Choice of anchors: the points a center is tied to, and how strongly. It is settled once, when a body is made.
#pragma once

#include <array>
#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

#include "simd/float4.hpp"

namespace morula::detail {

struct AnchorChoice {
  std::vector<std::uint32_t> points;  ///< ascending
  std::vector<double> weights;        ///< one per point, none zero; they add up to 1
  bool reproduces = false;            ///< the weighted sum is the center; otherwise it falls short of it
  bool degenerate = false;            ///< fewer than four anchors that span space: equal weights
  /// Three anchors that show how all of them turn; repeated ones where they are collinear or fewer.
  std::array<std::uint32_t, 3> axes{};
};

/// candidates: points that may become anchors, ascending, each once; none gives no anchors.
/// radius: that of the sphere about the center, which sets the scale.
///
/// About sixteen near points on all sides of the center. Weights as small as can be, so that noise of single vertices
/// averages out, and none or only mildly negative. A center far outside the hull of all candidates has no such weights.
AnchorChoice choose_anchors(const Vec3& center, double radius, std::span<const LocalPoint> points,
                            std::span<const std::uint32_t> candidates);

}  // namespace morula::detail
