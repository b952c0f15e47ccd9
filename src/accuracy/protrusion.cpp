// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <morula/accuracy/measure.hpp>
#include <morula/geometry/sampling.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "accuracy/usable_spheres.hpp"
#include "parallel/float_environment.hpp"
#include "parallel/interruption.hpp"

namespace morula {
using namespace detail;
namespace {

void require_usable_tolerance(double tolerance) {
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    throw std::invalid_argument("protrusion: the tolerance must be positive and finite, not " +
                                std::to_string(tolerance));
}

// A cube of the octree, with its bound.
struct Cell {
  Vec3 center;
  double half_edge;
  double upper;  // bound of the protrusion of points in both the cube and the ball
};

Vec3 farthest_corner(const Cell& cell, const Vec3& from) {
  const auto away = [&](double center, double p) { return center + (center >= p ? cell.half_edge : -cell.half_edge); };
  return {away(cell.center.x, from.x), away(cell.center.y, from.y), away(cell.center.z, from.z)};
}

class ProtrusionSearch {
 public:
  ProtrusionSearch(const SignedDistance& object, const Sphere& ball, double tolerance)
      : object_(object),
        ball_(ball),
        // Distances are also rounded: below this, refinement would never end.
        tolerance_(std::max(tolerance * ball.radius, 0x1p-46 * (max_norm(ball.center) + ball.radius))) {}

  BallProtrusion run() {
    // φ is 1-Lipschitz, so r + φ(c) is an upper bound; if the direction to the nearest surface point (or away from it,
    // outside) continues straight, as for convex objects, the end of that radius attains it.
    const SignedDistance::Result at_center = object_.at(ball_.center);
    best_ = std::max(0.0, at_center.distance);
    upper_ = std::max(0.0, ball_.radius + at_center.distance);
    if (is_settled()) return result();
    climb(uphill(ball_.center, at_center));
    if (is_settled()) return result();
    climb(best_of_directions());
    if (is_settled()) return result();
    branch_and_bound();
    return result();
  }

 private:
  bool is_settled() const { return upper_ <= best_ + tolerance_; }
  BallProtrusion result() const { return {best_, std::max(best_, upper_)}; }

  SignedDistance::Result look_at(const Vec3& p) {
    poll_interrupt_();
    const SignedDistance::Result found = object_.at(p);
    best_ = std::max(best_, found.distance);
    return found;
  }

  // Direction in which φ grows fastest; none on the surface.
  static Vec3 uphill(const Vec3& p, const SignedDistance::Result& at) {
    const Vec3 away = at.distance > 0 ? p - at.closest.point : at.closest.point - p;
    return normalized(away, {0, 0, 0});
  }

  // At the largest protrusion of the ball's surface, φ grows straight outward: the step goes to the point that would be
  // the largest if φ grew there as it does here.
  void climb(Vec3 direction) {
    constexpr int most_steps = 8;
    double reached = -1;
    for (int step = 0; step < most_steps && direction != Vec3{0, 0, 0} && !is_settled(); ++step) {
      const Vec3 p = ball_.center + ball_.radius * direction;
      const SignedDistance::Result found = look_at(p);
      if (found.distance <= reached + 0.1 * tolerance_) return;
      reached = found.distance;
      direction = uphill(p, found);
    }
  }

  Vec3 best_of_directions() {
    Vec3 best{};
    double farthest = -std::numeric_limits<double>::infinity();
    for (const Vec3& direction : fibonacci_directions(32)) {
      const double d = look_at(ball_.center + ball_.radius * direction).distance;
      if (d > farthest) farthest = d, best = direction;
    }
    return best;
  }

  void branch_and_bound() {
    const double from_center = upper_;
    double dropped = 0;
    std::vector<Cell> cells{{ball_.center, ball_.radius, upper_}};
    const auto lower_bound_first = [](const Cell& a, const Cell& b) { return a.upper < b.upper; };
    while (!cells.empty() && cells.front().upper > best_ + tolerance_) {
      std::pop_heap(cells.begin(), cells.end(), lower_bound_first);
      const Cell cell = cells.back();
      cells.pop_back();
      // Projecting into the ball shortens no distance to the ball's points, so a tested point of the ball near the
      // cube's center bounds the cube as well as the center itself would, and can be attained.
      const Vec3 p = projected(cell.center);
      const SignedDistance::Result at_p = look_at(p);
      const double bound = std::min(cell.upper, at_p.distance + std::sqrt(3.0) * cell.half_edge);
      if (bound <= best_ + tolerance_) {
        dropped = std::max(dropped, bound);
        continue;
      }
      for (int octant = 0; octant < 8; ++octant) {
        const double h = 0.5 * cell.half_edge;
        Cell child{cell.center + Vec3{octant & 1 ? h : -h, octant & 2 ? h : -h, octant & 4 ? h : -h}, h, bound};
        if (is_outside_ball(child)) continue;
        // The distance from the object is at most that from the surface point just found; when p is inside, φ grows
        // from there.
        child.upper = std::min(
            child.upper, at_p.distance > 0 ? distance(farthest_corner(child, at_p.closest.point), at_p.closest.point)
                                           : at_p.distance + distance(farthest_corner(child, p), p));
        if (child.upper <= best_ + tolerance_) {
          dropped = std::max(dropped, child.upper);
          continue;
        }
        cells.push_back(child);
        std::push_heap(cells.begin(), cells.end(), lower_bound_first);
      }
    }
    if (!cells.empty()) dropped = std::max(dropped, cells.front().upper);
    upper_ = std::min(from_center, std::max(best_, dropped));
  }

  Vec3 projected(const Vec3& p) const {
    const Vec3 from_center = p - ball_.center;
    const double squared = squared_length(from_center);
    if (squared <= ball_.radius * ball_.radius) return p;
    return ball_.center + from_center * (ball_.radius / std::sqrt(squared));
  }

  bool is_outside_ball(const Cell& cell) const {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double nearest = std::max(0.0, std::abs(cell.center[axis] - ball_.center[axis]) - cell.half_edge);
      squared += nearest * nearest;
    }
    return squared > ball_.radius * ball_.radius;
  }

  const SignedDistance& object_;
  Sphere ball_;
  double tolerance_;
  InterruptPoller poll_interrupt_{16};
  double best_ = 0;   // attained
  double upper_ = 0;  // proven
};

}  // namespace

BallProtrusion protrusion(const SignedDistance& object, const Sphere& ball, double tolerance) {
  const StandardFloats standard;
  require_usable(std::span(&ball, 1), "protrusion");
  require_usable_tolerance(tolerance);
  return ProtrusionSearch(object, ball, tolerance).run();
}

Protrusion protrusion(const SignedDistance& object, std::span<const Sphere> spheres, double tolerance,
                      WorkersOrAll given) {
  Workers& workers = given;
  const StandardFloats standard;
  require_usable(spheres, "protrusion");
  require_usable_tolerance(tolerance);
  std::vector<double> uppers(spheres.size());
  parallel_for(workers, spheres.size(), 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) uppers[i] = ProtrusionSearch(object, spheres[i], tolerance).run().upper;
  });
  Protrusion result;
  for (const double upper : uppers) {
    result.worst = std::max(result.worst, upper);
    result.mean += upper;
  }
  if (!spheres.empty()) result.mean /= static_cast<double>(spheres.size());
  return result;
}

}  // namespace morula
