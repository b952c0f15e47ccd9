// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/enclosing_sphere.hpp>
#include <morula/geometry/scale.hpp>
#include <vector>

#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

constexpr std::size_t most_support = 4;

struct Support {
  std::array<Sphere, most_support> spheres;
  std::size_t count = 0;
};

// The two spheres that all spheres of a support touch from inside, the smaller first; fewer if there are fewer, or if
// the centers are affinely dependent. With x the center relative to the first one's, R = rho + r0 and s_i = r0 - r_i,
// |x - d_i| = R - r_i is 2 d_i x = |d_i|^2 - s_i^2 - 2 rho s_i: x = a + rho b in the span of the d_i, and |x| = rho.
struct Tangents {
  std::array<Sphere, 2> spheres;
  std::size_t count = 0;

  explicit Tangents(const Support& support) {
    const Sphere& first = support.spheres[0];
    if (support.count == 1) {
      spheres[count++] = first;
      return;
    }
    std::array<Vec3, 3> basis;
    Vec3 a, b;
    for (std::size_t i = 1; i < support.count; ++i) {
      const Vec3 d = support.spheres[i].center - first.center;
      const double s = first.radius - support.spheres[i].radius;
      Vec3 rest = d;
      for (std::size_t k = 0; k + 1 < i; ++k) rest -= basis[k] * dot(rest, basis[k]);
      const double height = length(rest);
      if (!(height * height > 1e-20 * squared_length(d))) return;
      const Vec3 direction = rest / height;
      a += direction * ((0.5 * (squared_length(d) - s * s) - dot(a, d)) / height);
      b += direction * ((-s - dot(b, d)) / height);
      basis[i - 1] = direction;
    }
    // (|b|^2 - 1) rho^2 + 2 a b rho + |a|^2 = 0.
    const double square = squared_length(b) - 1, half = dot(a, b), constant = squared_length(a);
    const double discriminant = half * half - square * constant;
    if (!(discriminant >= 0)) return;
    const double q = -(half + std::copysign(std::sqrt(discriminant), half));
    for (const double rho : {q != 0 ? constant / q : 0, square != 0 ? q / square : -1})
      if (std::isfinite(rho) && rho >= 0) spheres[count++] = {first.center + a + b * rho, rho + first.radius};
    if (count == 2 && spheres[1].radius < spheres[0].radius) std::swap(spheres[0], spheres[1]);
  }
};

bool contains_all(const Sphere& sphere, std::span<const Sphere> spheres) {
  const double reach = sphere.radius * (1 + 1e-12);
  for (const Sphere& s : spheres)
    if (!(distance(sphere.center, s.center) + s.radius <= reach)) return false;
  return true;
}

// The smallest sphere that touches a subset with the last one and contains them all, for at most five spheres, the last
// of which reaches out of the sphere about the others. The search is exhaustive, as for points.
Sphere smallest_of_few(std::span<const Sphere> few, Support& best_support) {
  Sphere best{{}, -1};
  const unsigned last = 1u << (few.size() - 1);
  for (unsigned subset = last; subset < 2 * last; ++subset) {
    Support support;
    bool too_many = false;
    for (std::size_t i = 0; i < few.size() && !too_many; ++i) {
      if ((subset >> i & 1u) == 0) continue;
      too_many = support.count == most_support;
      if (!too_many) support.spheres[support.count++] = few[i];
    }
    if (too_many) continue;
    const Tangents tangents(support);
    for (std::size_t k = 0; k < tangents.count; ++k) {
      const Sphere& sphere = tangents.spheres[k];
      if ((best.radius >= 0 && sphere.radius >= best.radius) || !contains_all(sphere, few)) continue;
      best = sphere;
      best_support = support;
    }
  }
  return best;
}

std::size_t farthest(const Vec3& center, std::span<const Sphere> spheres, double& reach) {
  std::size_t index = 0;
  reach = -1;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const double r = distance(center, spheres[i].center) + spheres[i].radius;
    if (r > reach) reach = r, index = i;
  }
  return index;
}

// The center for spheres of ordinary size, relative to the first.
Vec3 center_by_pivots(std::span<const Sphere> spheres) {
  double reach = 0;
  Support support;
  support.spheres[support.count++] = spheres[farthest({}, spheres, reach)];
  Sphere sphere = support.spheres[0];
  // The radius grows with every pivot, so it ends; the cap only guards against rounding.
  constexpr int most_pivots = 100;
  for (int pivot = 0; pivot < most_pivots; ++pivot) {
    const std::size_t next = farthest(sphere.center, spheres, reach);
    if (reach <= sphere.radius * (1 + 1e-13)) break;
    std::array<Sphere, most_support + 1> few;
    for (std::size_t i = 0; i < support.count; ++i) few[i] = support.spheres[i];
    few[support.count] = spheres[next];
    Support next_support;
    const Sphere grown = smallest_of_few(std::span(few).first(support.count + 1), next_support);
    if (!(grown.radius > sphere.radius)) break;
    sphere = grown;
    support = next_support;
  }
  return sphere.center;
}

}  // namespace

double farthest_reach(const Vec3& center, std::span<const Sphere> spheres) {
  double largest = 0;
  for (const Sphere& s : spheres) largest = std::max(largest, scaled_length(s.center - center) + s.radius);
  return largest;
}

Sphere enclosing_sphere_of_spheres(std::span<const Sphere> spheres) {
  const StandardFloats standard;
  if (spheres.empty()) return {};
  if (spheres.size() == 1) return spheres[0];
  // Spheres are taken relative to the first, in a unit of their own: no square underflows or overflows, and far from
  // the origin differences are exact although squares are not.
  double size = 0;
  for (const Sphere& s : spheres) size = std::max({size, max_norm(s.center - spheres[0].center), s.radius});
  if (!(size > 0) || !std::isfinite(size)) return {spheres[0].center, farthest_reach(spheres[0].center, spheres)};
  const int exponent = std::ilogb(size);
  const auto scaled = [&](double x) { return std::ldexp(x, -exponent); };
  std::vector<Sphere> own;
  for (const Sphere& s : spheres) {
    const Vec3 from_first = s.center - spheres[0].center;
    own.push_back({{scaled(from_first.x), scaled(from_first.y), scaled(from_first.z)}, scaled(s.radius)});
  }
  const Vec3 found = center_by_pivots(own);
  const Vec3 center = spheres[0].center +
                      Vec3{std::ldexp(found.x, exponent), std::ldexp(found.y, exponent), std::ldexp(found.z, exponent)};
  return {center, farthest_reach(center, spheres)};
}

}  // namespace morula
