// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Corners of one facet that surround the others: only these need tests.
//
// A corner of a patch is a fixed combination of its facet's vertices, so relations in the plane of the weights (x, y)
// hold wherever the vertices are: a corner in the convex hull of others stays in their hull, and a sphere that contains
// those contains it.
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

/// Largest distance of a corner that is left out from the hull of the kept ones, in |x| + |y|. Corners on one cut line
/// differ from a line by an ulp, which would keep them all. rounding.hpp pays for twice as much, since nodes above
/// leaves leave out more of the corners that leaves keep.
// mutant hull-tolerance: `30` -> `18`
inline constexpr double hull_tolerance = 0x1p-30;

class FacetHull {
 public:
  /// Returns those of `points`, in order around their hull, that surround the others: every point lies within
  /// `tolerance` of the convex hull of the returned ones; with tolerance 0 in the hull itself, of real numbers. The one
  /// with the lowest corner stands for equal points. points: at least one, weights finite and at most 1; they are
  /// sorted. The result is valid until the next call. Cost: O(n log n), and the square of each run of near-collinear
  /// corners.
  std::span<const FacetPoint> surround(std::vector<FacetPoint>& points, double tolerance);

 private:
  void find_hull(const std::vector<FacetPoint>& sorted);
  void thin_out(double tolerance);

  std::vector<FacetPoint> hull_, thinned_;
};

}  // namespace morula::detail
