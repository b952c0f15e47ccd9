// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Proof that the hull loses nothing, in two steps.
//   hull     Two chains from the least to the greatest point [andrew1979], with exact signs of orientation and exact
//            comparisons of coordinates: they return the convex hull of real numbers. A point on the line of
//            its neighbors is dropped as well, and lies between them: points come in lexicographic order, which along
//            a line is the order on it.
//   thinning A corner of the hull is dropped when it is near the segment between the two corners *kept* on either side
//            of it, as a witness shows: a point of that segment not farther off than the tolerance. The witness is
//            a + t (b - a) for some t in 0...1, and lies on the segment for any t; only its three roundings, below
//            2^-50, are added. Corners are compared with kept ones, never with dropped ones, so errors do not add up.
// The hull of all corners is then within the tolerance of the hull of those kept: a convex combination of corners is as
// near to it as the farthest of them.
#include "update/points/facet_hull.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "geometry/exact_predicates.hpp"

namespace morula::detail {
namespace {

bool is_same_place(const FacetPoint& p, const FacetPoint& q) {
  return p.x == q.x && p.y == q.y;
}

bool turns_left(const FacetPoint& a, const FacetPoint& b, const FacetPoint& c) {
  constexpr Projection along_z{0, 1};
  return orient2d({a.x, a.y, 0}, {b.x, b.y, 0}, {c.x, c.y, 0}, along_z) > 0;
}

bool is_near_segment(const FacetPoint& p, const FacetPoint& a, const FacetPoint& b, double tolerance) {
  const double dx = b.x - a.x, dy = b.y - a.y, squared = dx * dx + dy * dy;
  const double share = squared > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / squared : 0;
  // mutant hull-beyond-the-segment: `share > 0 ? std::min(share, 1.0) : 0` -> `share`
  const double t = share > 0 ? std::min(share, 1.0) : 0;
  // mutant hull-twice-the-tolerance: `tolerance` -> `2 * tolerance`
  return std::abs(p.x - (a.x + t * dx)) + std::abs(p.y - (a.y + t * dy)) <= tolerance;
}

}  // namespace

std::span<const FacetPoint> FacetHull::surround(std::vector<FacetPoint>& points, double tolerance) {
  std::sort(points.begin(), points.end(), [](const FacetPoint& p, const FacetPoint& q) {
    return std::tie(p.x, p.y, p.corner) < std::tie(q.x, q.y, q.corner);
  });
  points.erase(std::unique(points.begin(), points.end(), is_same_place), points.end());
  find_hull(points);
  if (!(tolerance > 0)) return hull_;
  thin_out(tolerance);
  return thinned_;
}

void FacetHull::find_hull(const std::vector<FacetPoint>& sorted) {
  hull_.clear();
  if (sorted.size() < 3) {
    hull_ = sorted;
    return;
  }
  const auto add_chain = [&](auto begin, auto end) {
    const std::size_t first = hull_.size();
    for (auto p = begin; p != end; ++p) {
      while (hull_.size() >= first + 2 && !turns_left(*(hull_.end() - 2), hull_.back(), *p)) hull_.pop_back();
      hull_.push_back(*p);
    }
    hull_.pop_back();  // the other chain begins with this corner
  };
  add_chain(sorted.begin(), sorted.end());
  // mutant hull-without-one-chain: `add_chain(sorted.rbegin(), sorted.rend())` -> ``
  add_chain(sorted.rbegin(), sorted.rend());
}

void FacetHull::thin_out(double tolerance) {
  thinned_.clear();
  const std::size_t count = hull_.size();
  const auto at = [&](std::size_t i) -> const FacetPoint& { return hull_[i % count]; };
  const auto can_skip_between = [&](std::size_t i, std::size_t j) {
    // mutant hull-steps-add-up: `i +` -> `j -`
    for (std::size_t k = i + 1; k < j; ++k)
      if (!is_near_segment(at(k), at(i), at(j), tolerance)) return false;
    return true;
  };
  for (std::size_t i = 0; i < count;) {
    thinned_.push_back(at(i));
    std::size_t next = i + 1;
    while (next < count && can_skip_between(i, next + 1)) ++next;
    i = next;
  }
}

}  // namespace morula::detail
