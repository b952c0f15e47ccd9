// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/sphere_fit.hpp"

#include <algorithm>
#include <array>
#include <morula/geometry/enclosing_sphere.hpp>
#include <vector>

namespace morula::detail {
namespace {

// The points that decide radii: an even thinning first, to which the farthest points found are added.
constexpr std::size_t most_core_points = 256;

class Search {
 public:
  Search(std::span<const Vec3> points, const SignedDistance& shape) : points_(points), shape_(shape) {
    const std::size_t step = std::max<std::size_t>(1, (points.size() + most_core_points - 1) / most_core_points);
    for (std::size_t i = 0; i < points.size(); i += step) core_.push_back(points[i]);
  }

  struct Trial {
    Vec3 center;
    double radius;
    double protrusion;
  };
  Trial evaluate(const Vec3& center) const {
    const double radius = farthest_distance(center, core_);
    return {center, radius, std::max(0.0, radius + shape_(center))};
  }

  // Compass search: step along the axes, repeat improving steps, halve the step when none improves.
  Trial descend(Trial best, double step, double last_step) const {
    constexpr std::array<Vec3, 6> directions{Vec3{1, 0, 0},  Vec3{-1, 0, 0}, Vec3{0, 1, 0},
                                             Vec3{0, -1, 0}, Vec3{0, 0, 1},  Vec3{0, 0, -1}};
    std::size_t first = 0;
    while (step > last_step) {
      bool improved = false;
      for (std::size_t k = 0; k < directions.size() && !improved; ++k) {
        const std::size_t d = (first + k) % directions.size();
        const Trial trial = evaluate(best.center + directions[d] * step);
        if (trial.protrusion < best.protrusion) best = trial, first = d, improved = true;
      }
      if (!improved) step *= 0.5;
    }
    return best;
  }

  // Adds the farthest of all points to the core if it decides the radius; false when the core was right.
  bool correct(const Vec3& center, double core_radius) {
    double farthest = 0;
    Vec3 at;
    for (const Vec3& p : points_)
      if (const double d = squared_distance(center, p); d > farthest) farthest = d, at = p;
    if (std::sqrt(farthest) <= core_radius * (1 + 1e-9)) return false;
    core_.push_back(at);
    return true;
  }

 private:
  std::span<const Vec3> points_;
  const SignedDistance& shape_;
  std::vector<Vec3> core_;
};

}  // namespace

Sphere recenter(std::span<const Vec3> points, const Vec3& start, const SignedDistance& shape) {
  const Sphere smallest = enclosing_sphere(points);
  Search search(points, shape);
  Search::Trial best = search.evaluate(smallest.center);
  if (const Search::Trial other = search.evaluate(start); other.protrusion < best.protrusion) best = other;
  constexpr double first_step = 0.2, last_step = 0.03;  // shares of the smallest radius
  best = search.descend(best, first_step * smallest.radius, last_step * smallest.radius);
  constexpr int most_corrections = 2;
  for (int i = 0; i < most_corrections && search.correct(best.center, best.radius); ++i)
    best = search.descend(search.evaluate(best.center), 2 * last_step * smallest.radius, last_step * smallest.radius);
  return {best.center, farthest_distance(best.center, points)};
}

}  // namespace morula::detail
