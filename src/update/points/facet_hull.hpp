// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Corners of one facet that surround the others: only these have to be tested.
//
// A corner of a patch is a fixed combination of its facet's vertices, so what holds in the plane of the weights (x, y)
// holds wherever the vertices are: a corner in the convex hull of others stays in their hull, and a sphere that
// contains those contains it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace morula::detail {

/// A corner in the plane of its facet: the weights of the facet's second and third vertex.
struct FacetPoint {
  std::uint32_t corner;
  double x, y;
};

/// How far a corner that is left out may lie from the hull of those kept, in |x| + |y|. Corners on one cut line differ
/// from a line by an ulp, which would keep them all. rounding.hpp pays for twice as much, since nodes above leaves
/// leave out more of what leaves keep.
// mutant hull-tolerance: `30` -> `18`
inline constexpr double hull_tolerance = 0x1p-30;

class FacetHull {
 public:
  /// Those of `points`, in order around their hull, that surround the others: every point lies within `tolerance` of
  /// the convex hull of those returned; with tolerance 0 in the hull itself, of real numbers. Of equal points the one
  /// with the lowest corner counts. points: at least one, weights finite and at most 1; they are put into order.
  /// Valid until the next call. O(n log n) and what near-collinear corners cost: the square of a run of them.
  std::span<const FacetPoint> surround(std::vector<FacetPoint>& points, double tolerance);

 private:
  void find_hull(const std::vector<FacetPoint>& sorted);
  void thin_out(double tolerance);

  std::vector<FacetPoint> hull_, thinned_;
};

}  // namespace morula::detail
