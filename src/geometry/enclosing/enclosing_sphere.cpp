// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <morula/geometry/box.hpp>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/random.hpp>
#include <morula/geometry/scale.hpp>
#include <vector>

#include "geometry/enclosing/farthest.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

struct Support {
  std::array<Vec3, 4> points;
  int count = 0;
};

// Smallest sphere with all support points on it. Points that are affinely dependent on the earlier ones are left out;
// `independent` says how many were used.
Sphere circumsphere(const Support& support, int& independent) {
  // Centre = p0 + Σ λ_i d_i with d_i = p_i − p0 and d_j·(Σ λ_i d_i) = |d_j|²/2; solved by Gram–Schmidt, which shows
  // dependence as a vanishing remainder.
  std::array<Vec3, 3> basis;
  Vec3 center = support.count > 0 ? support.points[0] : Vec3{};
  independent = support.count > 0 ? 1 : 0;
  double squared_radius = 0;
  int dimension = 0;
  for (int i = 1; i < support.count; ++i) {
    Vec3 rest = support.points[i] - support.points[0];
    const double squared = squared_length(rest);
    for (int k = 0; k < dimension; ++k) rest -= basis[k] * dot(rest, basis[k]);
    const double height = length(rest);
    if (!(height * height > 1e-20 * squared)) continue;
    const Vec3 direction = rest / height;
    // Move the centre along the new direction until the new point is as far as the others.
    const Vec3 to_point = support.points[i] - center;
    const double shift = (squared_length(to_point) - squared_radius) / (2 * dot(to_point, direction));
    center += direction * shift;
    squared_radius += shift * shift;
    basis[dimension++] = direction;
    ++independent;
  }
  return {center, std::sqrt(squared_radius)};
}

// Smallest enclosing sphere of at most five points, the last of which is outside that of the others: the smallest
// circumsphere of a subset that has the last point and contains them all. Exhaustive, so nothing about the order of
// points can go wrong. Returns the support. Computed relative to the first point: far from the origin, coordinates
// differ exactly although their squares do not.
Sphere smallest_of_few(std::span<const Vec3> absolute, Support& best_support) {
  std::array<Vec3, 5> relative;
  for (std::size_t i = 0; i < absolute.size(); ++i) relative[i] = absolute[i] - absolute[0];
  const std::span<const Vec3> points(relative.data(), absolute.size());
  Sphere best{{}, -1};
  unsigned best_subset = 0;
  const unsigned last = 1u << (points.size() - 1);
  for (unsigned subset = last; subset < 2 * last; ++subset) {
    Support support;
    bool too_many = false;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (subset >> i & 1u) {
        if (support.count == 4) {
          too_many = true;
          break;
        }
        support.points[support.count++] = points[i];
      }
    if (too_many) continue;
    int independent = 0;
    const Sphere sphere = circumsphere(support, independent);
    if (independent < support.count) continue;
    if (best.radius >= 0 && sphere.radius >= best.radius) continue;
    const double reach = sphere.radius * (1 + 1e-12);
    bool contains_all = true;
    for (const Vec3& p : points) contains_all = contains_all && squared_distance(p, sphere.center) <= reach * reach;
    if (contains_all) {
      best = sphere;
      best_subset = subset;
    }
  }
  best.center += absolute[0];
  best_support.count = 0;
  for (std::size_t i = 0; i < absolute.size(); ++i)
    if (best_subset >> i & 1u) best_support.points[best_support.count++] = absolute[i];
  return best;
}

class Columns {
 public:
  explicit Columns(std::span<const Vec3> points) : count_(points.size()), numbers_(3 * points.size()) {
    for (std::size_t i = 0; i < count_; ++i)
      numbers_[i] = points[i].x, numbers_[count_ + i] = points[i].y, numbers_[2 * count_ + i] = points[i].z;
  }
  /// The first of the farthest.
  std::size_t farthest_from(const Vec3& center) const {
    const double* const x = numbers_.data();
    return farthest_kernels().from_in_double({x, x + count_, x + 2 * count_, count_}, center);
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

// start: a point that is far from another.
Sphere by_pivots(std::span<const Vec3> points, const Columns& columns, const Vec3& start) {
  Support support;
  support.points[support.count++] = start;
  Sphere sphere{support.points[0], 0};
  // Take in the farthest point, keep what supports the sphere. The radius grows with every pivot, so it ends; the cap
  // only guards against rounding, and the final radius is measured anyway.
  constexpr int most_pivots = 100;
  for (int pivot = 0; pivot < most_pivots; ++pivot) {
    const std::size_t next = columns.farthest_from(sphere.center);
    if (squared_distance(sphere.center, points[next]) <= sphere.radius * sphere.radius * (1 + 1e-13)) break;
    std::array<Vec3, 5> few;
    for (int i = 0; i < support.count; ++i) few[i] = support.points[i];
    few[support.count] = points[next];
    Support next_support;
    const Sphere grown = smallest_of_few(std::span(few).first(support.count + 1), next_support);
    if (!(grown.radius > sphere.radius)) break;
    sphere = grown;
    support = next_support;
  }
  return sphere;
}

// The points about the first, so large that squares are ordinary: scaling by a power of two changes no digit.
Sphere enclosing_sphere_of_extremes(std::span<const Vec3> points) {
  Box box;
  for (const Vec3& p : points) box.add(p);
  // In halves, whose difference cannot overflow.
  const double half_extent = max_norm(box.upper * 0.5 - box.lower * 0.5);
  if (!(half_extent > 0) || !std::isfinite(half_extent)) return {points[0], farthest_distance(points[0], points)};
  const int exponent = -1 - std::ilogb(half_extent);
  std::vector<Vec3> scaled;
  for (const Vec3& p : points) scaled.push_back(times_power_of_two(p * 0.5 - points[0] * 0.5, exponent));
  const Columns columns(scaled);
  const Sphere sphere = by_pivots(scaled, columns, scaled[columns.farthest_from({})]);
  const Vec3 center = points[0] + times_power_of_two(sphere.center, 1 - exponent);
  return {center, farthest_distance(center, points)};
}

}  // namespace

double farthest_distance(const Vec3& center, std::span<const Vec3> points) {
  double largest = 0;
  for (const Vec3& p : points) largest = std::max(largest, squared_distance(center, p));
  // Of other squares something vanished, or overflowed.
  if (largest > 0x1p-900 && largest < std::numeric_limits<double>::infinity()) return std::sqrt(largest);
  double farthest = 0;
  for (const Vec3& p : points) farthest = std::max(farthest, scaled_length(p - center));
  return farthest;
}

Sphere enclosing_sphere(std::span<const Vec3> points) {
  const StandardFloats standard;
  if (points.empty()) return {};
  const Columns columns(points);
  const Vec3& opposite = points[columns.farthest_from(points[0])];
  if (!is_ordinary(squared_distance(points[0], opposite))) return enclosing_sphere_of_extremes(points);
  Sphere sphere = by_pivots(points, columns, opposite);
  sphere.radius = farthest_distance(sphere.center, points);
  return sphere;
}

}  // namespace morula
