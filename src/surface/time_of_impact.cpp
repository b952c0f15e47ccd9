// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Conservative advancement over separating directions.
#include <algorithm>
#include <array>
#include <limits>
#include <morula/geometry/scale.hpp>
#include <morula/surface/swept.hpp>
#include <stdexcept>

#include "parallel/float_environment.hpp"
#include "surface/pairs/feature_filter.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
/// The most steps for one pair; hardly any pair needs twenty. The rest of the interval then counts as not proven, from
/// the time reached on.
constexpr int most_steps = 1000;
/// A step that gains less time than this counts as none.
constexpr double least_gain = 0x1p-24;

/// The points of two features relative to one of the points, so that numbers are as small as the pair.
class Pair {
 public:
  Pair(std::span<const Vec3> a_from, std::span<const Vec3> a_to, std::span<const Vec3> b_from,
       std::span<const Vec3> b_to, double distance)
      : size_a_(a_from.size()), size_b_(b_from.size()), distance_(distance) {
    const Vec3 middle = a_from[0];
    const auto take = [&](std::span<const Vec3> points, std::array<Vec3, 3>& into) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        into[i] = points[i] - middle;
        reach_ = std::max(reach_, max_norm(into[i]));
      }
    };
    take(a_from, a_from_), take(a_to, a_to_), take(b_from, b_from_), take(b_to, b_to_);
  }

  /// The first time that is not proven to be free of impacts; more than 1 when all times are.
  double advance() const {
    double time = 0, ahead = 1;
    for (int steps = 0; steps < most_steps; ++steps) {
      const Vec3 direction = nearest_direction(time);
      double reached = last_apart(direction, time);
      if (reached > 1) return never;
      const double end = std::min(1.0, time + ahead);
      if (is_apart(direction, time, end)) {
        reached = std::max(reached, end);
        ahead *= 2;
      } else {
        ahead /= 8;
      }
      // If features are so near that the direction between nearest points is mostly rounding, a direction of the
      // features themselves may still separate them.
      if (!(reached - time >= least_gain) && ahead < least_gain)
        reached = std::max({reached, last_apart(normal(time), time), last_apart(-normal(time), time)});
      if (reached >= 1) return never;
      if (!(reached - time >= least_gain) && ahead < least_gain) return reached;
      time = reached;
    }
    return time;
  }

 private:
  using Points = std::array<Vec3, 3>;
  static Vec3 at(const Vec3& from, const Vec3& to, double time) { return from + (to - from) * time; }
  std::span<const Vec3> first(const Points& points, std::size_t size) const { return std::span(points).first(size); }

  struct Pose {
    Points a, b;
  };
  Pose pose(double time) const {
    Pose p;
    for (std::size_t i = 0; i < size_a_; ++i) p.a[i] = at(a_from_[i], a_to_[i], time);
    for (std::size_t j = 0; j < size_b_; ++j) p.b[j] = at(b_from_[j], b_to_[j], time);
    return p;
  }
  /// The direction from a to b, of largest |coordinate| 1; zero where they touch.
  Vec3 nearest_direction(double time) const {
    const Pose p = pose(time);
    const PairKind kind = size_a_ == 2   ? PairKind::edge_edge
                          : size_a_ == 1 ? PairKind::vertex_facet
                                         : PairKind::facet_vertex;
    const ProximityPair nearest = nearest_points({kind}, first(p.a, size_a_), first(p.b, size_b_));
    return scaled(nearest.point_b - nearest.point_a);
  }
  Vec3 normal(double time) const {
    const auto [a, b] = pose(time);
    return scaled(size_a_ == 2   ? cross(a[1] - a[0], b[1] - b[0])
                  : size_a_ == 1 ? cross(b[1] - b[0], b[2] - b[0])
                                 : cross(a[1] - a[0], a[2] - a[0]));
  }
  static Vec3 scaled(const Vec3& v) {
    const double largest = max_norm(v);
    if (!(largest > 0) || !is_finite(v)) return {};
    const Vec3 direction = v / largest;
    return is_finite(direction) ? direction : Vec3{};
  }
  /// The lower bound that a gap along a direction has to exceed: the distance that counts as an impact, plus an
  /// allowance for rounding. Coordinates are differences (2^-53 of them), heights sums of three products (3 × 2^-53 of
  /// their sizes), gaps at a time another difference, product and sum: together less than 2^-48 |direction|_1 reach,
  /// and |direction|_1 is at most 3.
  double allowance(const Vec3& direction) const {
    const double size = length(direction) * (1 + 0x1p-50);
    // mutant impact-rounding: `0x1p-46 * 3` -> `0`
    // mutant impact-distance: `distance_` -> `0.7 * distance_`
    return (distance_ * size) * (1 + 0x1p-50) + 0x1p-46 * 3 * reach_ + 0x1p-1000;
  }

  /// Whether the two are apart from `begin` to `end` by a direction that turns from the given one to that of the
  /// nearest points at the end.
  ///
  /// n(u) = (1 − u) m + u n and the difference w(u) = (1 − u) w0 + u w1 of one point of b and one of a are linear in
  /// the share u of the interval, so the gap n(u) · w(u) is quadratic: in Bernstein's form m·w0, (m·w1 + n·w0) / 2,
  /// n·w1. It is not less than the least of the three. |n(u)| is not more than the larger of |m| and |n|.
  bool is_apart(const Vec3& direction, double begin, double end) const {
    if (!(end > begin)) return false;
    const Vec3 turned = nearest_direction(end);
    // Points at both ends are rounded by 2^-52 of their coordinates: less than the allowance.
    // mutant impact-first-direction: `std::max(allowance(direction), allowance(turned))` -> `allowance(turned)`
    // mutant impact-turned-direction: `std::max(allowance(direction), allowance(turned))` -> `allowance(direction)`
    const double allowed = std::max(allowance(direction), allowance(turned));
    const Pose at_begin = pose(begin), at_end = pose(end);
    for (std::size_t i = 0; i < size_a_; ++i)
      for (std::size_t j = 0; j < size_b_; ++j) {
        const Vec3 w0 = at_begin.b[j] - at_begin.a[i], w1 = at_end.b[j] - at_end.a[i];
        if (!(dot(direction, w0) > allowed) || !(dot(turned, w1) > allowed) ||
            // mutant impact-bernstein: `!(0.5 * (dot(direction, w1) + dot(turned, w0)) > allowed)` -> `false`
            !(0.5 * (dot(direction, w1) + dot(turned, w0)) > allowed))
          return false;
      }
    return true;
  }

  /// The last time, from `time` on, up to which the direction (from a to b) separates all points; `time` when it does
  /// not separate them there, more than 1 when it does to the end.
  ///
  /// Over a step, every point's height along a fixed direction is linear in time, and so is the difference g of the
  /// heights of one point of b and one of a. If g, less the distance that counts as an impact and less the allowance
  /// for rounding, is positive at two times, it is positive between them: so it is enough to evaluate it at `time` and
  /// at 1, and to take the first zero between them if it is not positive at 1. All of b lies beyond all of a when all
  /// such differences are positive, since a feature is the hull of its points.
  double last_apart(const Vec3& direction, double time) const {
    const double allowed = allowance(direction);
    double last = never;
    for (std::size_t i = 0; i < size_a_; ++i) {
      const double a_start = dot(direction, a_from_[i]), a_end = dot(direction, a_to_[i]);
      for (std::size_t j = 0; j < size_b_; ++j) {
        const double start = dot(direction, b_from_[j]) - a_start, end = dot(direction, b_to_[j]) - a_end;
        const double here = start + (end - start) * time - allowed, there = end - allowed;
        if (!(here > 0)) return time;
        if (there > 0) continue;
        // The quotient is off by 2^-51, in which time no gap shrinks by more than 2^-51 × 6 reach: the allowance
        // contains that.
        last = std::min(last, time + (1 - time) * (here / (here - there)));
      }
    }
    return last;
  }

  std::size_t size_a_, size_b_;
  double distance_;
  double reach_ = 0;
  Points a_from_, a_to_, b_from_, b_to_;
};

}  // namespace

double time_of_impact(std::span<const Vec3> a_from, std::span<const Vec3> a_to, std::span<const Vec3> b_from,
                      std::span<const Vec3> b_to, double distance) {
  const StandardFloats standard;
  const bool is_vertex_facet = a_from.size() == 1 && b_from.size() == 3;
  const bool is_facet_vertex = a_from.size() == 3 && b_from.size() == 1;
  const bool is_edge_edge = a_from.size() == 2 && b_from.size() == 2;
  if (!(is_vertex_facet || is_facet_vertex || is_edge_edge) || a_to.size() != a_from.size() ||
      b_to.size() != b_from.size())
    throw std::invalid_argument("time_of_impact needs a vertex and a facet, or two edges, at both ends of the step");
  return Pair(a_from, a_to, b_from, b_to, distance).advance();
}

}  // namespace morula
