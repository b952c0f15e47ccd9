// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
//
// Facets about the first corner are right when none of them turns against another and together they turn less than once
// around that corner: each direction from it then leads through one facet at most, and the sum of the facets' areas is
// the area of the polygon. Otherwise ears are cut off: corners that turn left and whose triangle no side enters. A
// polygon without crossings always has one [meisters1975]; the rest after the cut has no crossing either. If two sides
// cross, each enters every triangle on the other, on either side of it: neither is cut off, and no ear is left in the
// end.
//
// Sides may lie on each other and corners on sides. Sides that go out and come back the same way (spikes) enclose
// nothing, yet one of their corners may look like an ear; so they are cut off first, as facets without area. Corners on
// a straight line are no ears: a polygon with area has other ears, and one without area has spikes at its ends.
#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>

#include "parallel/interruption.hpp"

namespace morula::detail {
namespace {

// The number of tests allowed per corner, in addition to the tests allowed for every file: a bound for files that were
// made to be slow.
constexpr std::uint64_t tests_per_corner = 4096;

// A sum of products of differences in double is off by less than this share of the sum of their sizes for up to a
// thousand corners. A sum that may be only rounding does not determine the plane of a polygon.
constexpr double certain_share = 0x1p-40;

constexpr double most_bent = 0.1;

bool is_certain(double value, double size) {
  return std::abs(value) > certain_share * size;
}

double range_scale(std::span<const Vec3> points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  // Cubes of coordinates stay in the range of double.
  // mutant polygon-out-of-range: `if (largest == 0 || (largest > 0x1p-100 && largest < 0x1p100)) return` -> `return`
  if (largest == 0 || (largest > 0x1p-100 && largest < 0x1p100)) return 1;
  return std::ldexp(1.0, std::clamp(-std::ilogb(largest), -1000, 1000));
}

}  // namespace

PolygonShape PolygonCutter::cut(std::span<const Vec3> points, std::span<const std::uint32_t> corners,
                                std::span<Facet> facets) {
  for (std::size_t k = 2; k < corners.size(); ++k) facets[k - 2] = {corners[0], corners[k - 1], corners[k]};
  if (corners.size() < 4) return {};
  tests_left_ += tests_per_corner * corners.size();
  points_.clear();
  for (const std::uint32_t corner : corners) points_.push_back(points[corner]);
  const View seen = view();
  PolygonShape shape{.cut = PolygonCut::fan, .bent = seen.bent};
  if (is_fan(seen.projection)) return shape;
  shape.cut = PolygonCut::ears;
  // Facets of the wrong orientation add up to an area of the opposite sign, which cannot fill a polygon.
  if (!cut_ears(seen.projection, seen.likely_turn, corners, facets) &&
      !cut_ears(seen.projection, -seen.likely_turn, corners, facets)) {
    shape.cut = PolygonCut::crossing;
    for (std::size_t k = 2; k < corners.size(); ++k) facets[k - 2] = {corners[0], corners[k - 1], corners[k]};
  }
  return shape;
}

// The normal is Newell's, the sum of those of the facets about the first corner.
PolygonCutter::View PolygonCutter::view() const {
  const double scale = range_scale(points_);
  const Vec3 first = points_[0] * scale;
  Vec3 normal{}, size{};
  Vec3 u = points_[1] * scale - first;
  for (std::size_t k = 2; k < points_.size(); ++k) {
    const Vec3 v = points_[k] * scale - first;
    normal += cross(u, v);
    size += Vec3{std::abs(u.y * v.z) + std::abs(u.z * v.y), std::abs(u.z * v.x) + std::abs(u.x * v.z),
                 std::abs(u.x * v.y) + std::abs(u.y * v.x)};
    u = v;
  }
  bool any_certain = false;
  for (int axis = 0; axis < 3; ++axis) any_certain = any_certain || is_certain(normal[axis], size[axis]);
  int dropped = 0;
  for (int axis = 1; axis < 3; ++axis) {
    const Vec3& by = any_certain ? normal : size;
    if (std::abs(by[axis]) > std::abs(by[dropped])) dropped = axis;
  }
  View seen{projections[dropped], normal[dropped] < 0 ? -1 : 1, false};
  const double length_of_normal = length(normal);
  if (!any_certain || !(length_of_normal > 0)) return seen;
  double low = 0, high = 0;
  Vec3 least = first, most = first;
  for (const Vec3& p : points_) {
    const Vec3 q = p * scale;
    const double height = dot(normal, q - first) / length_of_normal;
    low = std::min(low, height);
    high = std::max(high, height);
    for (int axis = 0; axis < 3; ++axis) {
      least[axis] = std::min(least[axis], q[axis]);
      most[axis] = std::max(most[axis], q[axis]);
    }
  }
  seen.bent = high - low > most_bent * length(most - least);
  return seen;
}

// If facets do not turn against each other, the direction from the first corner goes one way round. It begins on the
// first side's line; once it has been on the right, it may not come back. Corners that repeat the first one at either
// end have no direction and do no harm.
bool PolygonCutter::is_fan(Projection projection) const {
  const auto is_first = [&](std::size_t k) {
    return points_[k][projection.first] == points_[0][projection.first] &&
           points_[k][projection.second] == points_[0][projection.second];
  };
  std::size_t begin = 1, end = points_.size();
  while (begin < end && is_first(begin)) ++begin;
  while (begin < end && is_first(end - 1)) --end;
  int turn = 0;
  bool was_beyond = false;
  for (std::size_t k = begin + 1; k < end; ++k) {
    const int sign = orient2d(points_[0], points_[k - 1], points_[k], projection);
    // mutant polygon-fan-turns-back: `0` -> `0 && k < 4`
    if (sign * turn < 0) return false;
    if (turn == 0) turn = sign;
    const int side = turn * orient2d(points_[0], points_[begin], points_[k], projection);
    // mutant polygon-fan-turns-twice: `0` -> `0 && false`
    if (was_beyond && side >= 0) return false;
    was_beyond = was_beyond || side < 0;
  }
  return true;
}

bool PolygonCutter::may_test(std::uint64_t tests) {
  if (tests > tests_left_) return false;
  tests_left_ -= tests;
  constexpr std::uint64_t tests_per_look = std::uint64_t{1} << 20;
  tests_since_look_ += tests;
  if (tests_since_look_ >= tests_per_look) {
    tests_since_look_ = 0;
    check_interrupt();
  }
  return true;
}

bool PolygonCutter::same_place(std::size_t a, std::size_t b) const {
  const auto [first, second] = projection_;
  return points_[a][first] == points_[b][first] && points_[a][second] == points_[b][second];
}

// Whether p is strictly inside the segment, for three points on a line.
bool PolygonCutter::lies_between(std::size_t p, std::size_t a, std::size_t b) const {
  for (const int axis : {projection_.first, projection_.second}) {
    const double x = points_[p][axis], one = points_[a][axis], other = points_[b][axis];
    if (x < std::min(one, other) || x > std::max(one, other)) return false;
  }
  return !same_place(p, a) && !same_place(p, b);
}

PolygonCutter::Corner PolygonCutter::classify(std::size_t corner) const {
  const std::size_t a = previous_[corner], c = next_[corner];
  const int sign = orient(a, corner, c);
  if (sign != 0) return sign > 0 ? Corner::convex : Corner::reflex;
  return lies_between(corner, a, c) ? Corner::flat : Corner::spike;
}

// Whether the corner is an ear. No other side may enter the open triangle: a line through one of its sides, or the side
// itself, separates them. Nor may a corner touch the diagonal, which would leave a facet without area.
bool PolygonCutter::is_ear(std::size_t corner) const {
  const std::size_t a = previous_[corner], b = corner, c = next_[corner];
  const auto [first, second] = projection_;
  const auto range = [&](int axis) { return std::minmax({points_[a][axis], points_[b][axis], points_[c][axis]}); };
  const auto [left, right] = range(first);
  const auto [low, high] = range(second);
  for (std::size_t p = c; p != a; p = next_[p]) {
    const std::size_t q = next_[p];
    const Vec3 &from = points_[p], &to = points_[q];
    if (std::max(from[first], to[first]) < left || std::min(from[first], to[first]) > right ||
        std::max(from[second], to[second]) < low || std::min(from[second], to[second]) > high)
      continue;
    // mutant polygon-ear-touched: `p != c` -> `false`
    if (p != c && orient(a, c, p) == 0 && lies_between(p, a, c)) return false;
    const auto is_beyond = [&](std::size_t from_corner, std::size_t to_corner) {
      return orient(from_corner, to_corner, p) <= 0 && orient(from_corner, to_corner, q) <= 0;
    };
    if (is_beyond(a, b) || is_beyond(b, c) || is_beyond(c, a)) continue;
    const int side_a = orient(p, q, a), side_b = orient(p, q, b), side_c = orient(p, q, c);
    // mutant polygon-ear-entered: `if ... , side_c}) > 0 && std::min({side_a, side_b, side_c}) < 0) return false` -> ``
    if (std::max({side_a, side_b, side_c}) > 0 && std::min({side_a, side_b, side_c}) < 0) return false;
  }
  return true;
}

// The next ear, cyclically from a corner on; the number of corners if there is none, or after too many tests.
std::size_t PolygonCutter::next_ear(std::size_t from, std::size_t left) {
  for (std::size_t k = 0; k < left; ++k, from = next_[from]) {
    if (kind_[from] != Corner::convex) continue;
    if (!may_test(left)) return points_.size();
    if (is_ear(from)) return from;
  }
  return points_.size();
}

bool PolygonCutter::cut_ears(Projection projection, int turn, std::span<const std::uint32_t> corners,
                             std::span<Facet> facets) {
  projection_ = projection;
  turn_ = turn;
  const std::size_t count = points_.size();
  next_.resize(count);
  previous_.resize(count);
  kind_.resize(count);
  spikes_.clear();
  for (std::size_t k = 0; k < count; ++k) {
    next_[k] = (k + 1) % count;
    previous_[k] = (k + count - 1) % count;
  }
  const auto look_at = [&](std::size_t k) {
    kind_[k] = classify(k);
    if (kind_[k] == Corner::spike) spikes_.push_back(k);
  };
  for (std::size_t k = 0; k < count; ++k) look_at(k);
  std::vector<bool> is_gone(count);
  std::size_t at = 0, done = 0;
  for (std::size_t left = count; left > 3; --left) {
    if (!may_test(left)) return false;
    std::size_t ear = count;
    while (ear == count && !spikes_.empty()) {
      // mutant polygon-spikes-last: `if ... ()] && kind_[spikes_.back()] == Corner::spike) ear = spikes_.back()` -> ``
      if (!is_gone[spikes_.back()] && kind_[spikes_.back()] == Corner::spike) ear = spikes_.back();
      spikes_.pop_back();
    }
    if (ear == count) ear = next_ear(at, left);
    if (ear == count) return false;
    const std::size_t before = previous_[ear], after = next_[ear];
    facets[done++] = {corners[before], corners[ear], corners[after]};
    is_gone[ear] = true;
    next_[before] = after;
    previous_[after] = before;
    look_at(before);
    look_at(after);
    // The next corner is skipped, because adjacent ears make slivers.
    at = next_[after];
  }
  const std::size_t before = previous_[at], after = next_[at];
  facets[done] = {corners[before], corners[at], corners[after]};
  // mutant polygon-last-facet-turned: `orient(before, at, after) >= 0` -> `true`
  return orient(before, at, after) >= 0;
}

}  // namespace morula::detail
