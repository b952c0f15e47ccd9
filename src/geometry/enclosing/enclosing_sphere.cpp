// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/reproducible.hpp>
#include <morula/geometry/scale.hpp>
#include <vector>

#include "geometry/enclosing/sphere_support.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// Smallest sphere with all points of a support on it. Points that are affinely dependent on the earlier ones are left
// out.
Sphere circumsphere(std::span<const Vec3> support) {
  // Center = p0 + Σ λ_i d_i with d_i = p_i − p0 and d_j·(Σ λ_i d_i) = |d_j|²/2; solved by Gram–Schmidt, which shows
  // dependence as a vanishing remainder.
  std::array<Vec3, 3> basis;
  Vec3 center = support[0];
  double squared_radius = 0;
  int dimension = 0;
  for (std::size_t i = 1; i < support.size(); ++i) {
    Vec3 rest = support[i] - support[0];
    const double squared = squared_length(rest);
    for (int k = 0; k < dimension; ++k) rest -= basis[k] * dot(rest, basis[k]);
    const double height = length(rest);
    if (!(height * height > 1e-20 * squared)) continue;
    const Vec3 direction = rest / height;
    // Moves the center along the new direction until the new point is as far as the others.
    const Vec3 to_point = support[i] - center;
    const double shift = (squared_length(to_point) - squared_radius) / (2 * dot(to_point, direction));
    center += direction * shift;
    squared_radius += shift * shift;
    basis[dimension++] = direction;
  }
  return {center, std::sqrt(squared_radius)};
}

// Smallest circumsphere of a subset of at most five points that has the last one and contains them all. Every such
// subset is examined, so the order of points cannot cause an error; skipped are only subsets that have a subset whose
// sphere contains all points or is no smaller than the best so far: a circumsphere is no smaller than the circumspheres
// of its subsets.
class SmallestOfFew {
 public:
  /// points: the last of them at the origin, last in order.
  explicit SmallestOfFew(std::span<const Vec3> points) : points_(points), last_(points.size() - 1) {
    grow({{}, 0, {}, {}, 0}, 0, 1u << last_);
  }
  /// One bit for each point of the support.
  unsigned subset() const { return best_; }

 private:
  // A sphere through the last point and some others, its center in the span of `directions`.
  struct Partial {
    Vec3 center;
    double squared_radius;
    std::array<Vec3, 3> directions;
    std::array<double, 3> inverse_squares;
    int dimension;
  };

  void grow(const Partial& partial, std::size_t first, unsigned subset) {
    for (std::size_t i = first; i < last_ && partial.dimension < 3; ++i) {
      const double squared = squared_length(points_[i]);
      Vec3 rest = points_[i];
      for (int k = 0; k < partial.dimension; ++k)
        rest -= partial.directions[k] * (dot(rest, partial.directions[k]) * partial.inverse_squares[k]);
      const double height = squared_length(rest);
      if (!(height > 1e-20 * squared)) continue;
      // The center moves along the new direction until the new point is as far as the others.
      const Vec3 to_point = points_[i] - partial.center;
      const double shift = (squared_length(to_point) - partial.squared_radius) / (2 * dot(to_point, rest));
      Partial larger = partial;
      larger.center += rest * shift;
      larger.squared_radius += shift * shift * height;
      // mutant enclosing-first-that-does: `!(larger.squared_radius < smallest_)` -> `best_ != 0`
      if (!(larger.squared_radius < smallest_)) continue;
      const unsigned with = subset | 1u << i;
      // mutant enclosing-without-all: `contains_all` -> `larger.dimension == 2 || contains_all`
      if (contains_all(larger, with)) {
        smallest_ = larger.squared_radius;
        best_ = with;
        continue;
      }
      larger.directions[larger.dimension] = rest;
      larger.inverse_squares[larger.dimension++] = 1 / height;
      // mutant enclosing-three-at-most: `grow` -> `if (larger.dimension < 2) grow`
      grow(larger, i + 1, with);
    }
  }
  bool contains_all(const Partial& sphere, unsigned subset) const {
    for (std::size_t i = 0; i < last_; ++i)
      if (!(subset >> i & 1u) && !(squared_distance(points_[i], sphere.center) <= sphere.squared_radius * (1 + 2e-12)))
        return false;
    return true;
  }

  std::span<const Vec3> points_;
  std::size_t last_;
  unsigned best_ = 0;
  double smallest_ = std::numeric_limits<double>::infinity();
};

// Smallest enclosing sphere of at most five points, the last of which is outside that of the others; with radius -1 if
// rounding leaves none. Computed relative to one of them: far from the origin, coordinates differ exactly although
// their squares do not.
SupportedSphere smallest_of_few(std::span<const Vec3> points) {
  std::array<Vec3, 5> relative;
  for (std::size_t i = 0; i < points.size(); ++i) relative[i] = points[i] - points.back();
  const unsigned subset = SmallestOfFew(std::span<const Vec3>(relative.data(), points.size())).subset();
  if (subset == 0) return {{{}, -1}};
  std::array<Vec3, 4> apart;
  SupportedSphere result;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (subset >> i & 1u) {
      apart[result.count] = points[i] - points[0];
      result.points[result.count++] = points[i];
    }
  // It is computed again from its support alone, so that it does not depend on the order of the search.
  result.sphere = circumsphere(std::span(apart).first(result.count));
  result.sphere.center += points[0];
  return result;
}

struct Farthest {
  Vec3 point;
  double squared_distance;
};
// The farthest point, the first of equals.
Farthest farthest_from(const DoublePointColumns& points, const Vec3& center) {
  const std::size_t i = farthest_kernels().from_in_double(points, center);
  const Vec3 point{points.x[i], points.y[i], points.z[i]};
  return {point, squared_distance(center, point)};
}

class Columns {
 public:
  explicit Columns(std::span<const Vec3> points) : count_(points.size()), numbers_(3 * points.size()) {
    for (std::size_t i = 0; i < count_; ++i)
      numbers_[i] = points[i].x, numbers_[count_ + i] = points[i].y, numbers_[2 * count_ + i] = points[i].z;
  }
  DoublePointColumns get() const {
    const double* const x = numbers_.data();
    return {x, x + count_, x + 2 * count_, count_};
  }

 private:
  std::size_t count_;
  std::vector<double> numbers_;
};

// Squares in this range come from lengths whose fourth powers, which circumspheres take, are normal numbers, down to
// parts of 2^-52 of them.
bool is_ordinary(double squared) {
  return squared > 0x1p-380 && squared < 0x1p500;
}

Vec3 times_power_of_two(const Vec3& v, int exponent) {
  return {std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
}

// Finds the sphere by pivots. The radius of the result reaches the farthest point.
SupportedSphere by_pivots(const SupportedSphere& start, const DoublePointColumns& points) {
  SupportedSphere best = start;
  // Each pivot adds the farthest point and keeps the support of the sphere. The radius grows with every pivot, so it
  // ends; the cap only guards against rounding.
  constexpr int most_pivots = 100;
  for (int pivot = 0;; ++pivot) {
    const Farthest next = farthest_from(points, best.sphere.center);
    SupportedSphere grown;
    if (pivot < most_pivots && next.squared_distance > best.sphere.radius * best.sphere.radius * (1 + 1e-13)) {
      std::array<Vec3, 5> few;
      // mutant enclosing-grown-loses-support: `[i];` -> `[0];`
      for (std::size_t i = 0; i < best.count; ++i) few[i] = best.points[i];
      few[best.count] = next.point;
      grown = smallest_of_few(std::span(few).first(best.count + 1));
    }
    if (!(grown.sphere.radius > best.sphere.radius)) {
      // mutant enclosing-not-measured: `best.sphere.radius = std::sqrt(next.squared_distance)` -> ``
      best.sphere.radius = std::sqrt(next.squared_distance);
      return best;
    }
    best = grown;
  }
}
SupportedSphere by_pivots_from(const Vec3& first, const DoublePointColumns& points) {
  return by_pivots({{first, 0}, {first}, 1}, points);
}

// The points are taken relative to the first, scaled so that squares are ordinary: scaling by a power of two changes no
// digit.
Sphere enclosing_sphere_of_extremes(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) box.add(p);
  // Halves are subtracted, whose difference cannot overflow.
  const double half_extent = max_norm(box.upper * 0.5 - box.lower * 0.5);
  if (!(half_extent > 0) || !std::isfinite(half_extent)) return {points[0], farthest_distance(points[0], points)};
  const int exponent = -1 - std::ilogb(half_extent);
  std::vector<Vec3> scaled;
  for (const Vec3& p : points) scaled.push_back(times_power_of_two(p * 0.5 - points[0] * 0.5, exponent));
  const Columns columns(scaled);
  const Sphere sphere = by_pivots_from(farthest_from(columns.get(), {}).point, columns.get()).sphere;
  const Vec3 center = points[0] + times_power_of_two(sphere.center, 1 - exponent);
  return {center, farthest_distance(center, points)};
}

}  // namespace

double farthest_distance(const Vec3& center, std::span<const Vec3> points) {
  double largest = 0;
  // mutant enclosing-last-point: `std::max(largest, squared_distance(center, p))` -> `squared_distance(center, p)`
  for (const Vec3& p : points) largest = std::max(largest, squared_distance(center, p));
  // In other squares a term has underflowed or overflowed.
  if (largest > 0x1p-900 && largest < std::numeric_limits<double>::infinity()) return std::sqrt(largest);
  double farthest = 0;
  for (const Vec3& p : points) farthest = std::max(farthest, scaled_length(p - center));
  return farthest;
}

Sphere enclosing_sphere(std::span<const Vec3> points) {
  return points.empty() ? Sphere{} : enclosing_sphere_from({}, Columns(points).get()).sphere;
}

SupportedSphere detail::enclosing_sphere_from(const SupportedSphere& start, const DoublePointColumns& points) {
  const StandardFloats standard;
  // Points of a support are of ordinary size; the radius shows whether the others are.
  if (start.count > 0) {
    const SupportedSphere found = by_pivots(start, points);
    // mutant enclosing-grown-from-extremes: `if (is_ordinary ... return` -> `return`
    if (is_ordinary(found.sphere.radius * found.sphere.radius)) return found;
  }
  const Farthest opposite = farthest_from(points, {points.x[0], points.y[0], points.z[0]});
  if (is_ordinary(opposite.squared_distance)) return by_pivots_from(opposite.point, points);
  std::vector<Vec3> in_rows;
  for (std::size_t i = 0; i < points.count; ++i) in_rows.push_back({points.x[i], points.y[i], points.z[i]});
  return {enclosing_sphere_of_extremes(in_rows)};
}

}  // namespace morula
