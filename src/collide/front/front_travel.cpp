// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "collide/front/front_walk.hpp"

namespace morula::detail {
namespace {

// A thousand times the ratio of pair tests' pads to a sphere's size: see placed_pair.hpp.
constexpr double verdict_rounding = 0x1p-16;

void stamp(Front::Side& side, const Collider& collider) {
  side.cover_id = collider.sphere_state().cover_id;
  side.frame = collider.sphere_state().frame;
  side.transform = collider.transform();
  side.origin = collider.sphere_state().origin;
}

double largest_extent(std::span<const Spheref> spheres) {
  float largest = 0;
  for (const Spheref& s : spheres)
    largest = std::max(largest, std::abs(s.center.x) + std::abs(s.center.y) + std::abs(s.center.z) + s.radius);
  return largest;
}

void stamp(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed) {
  stamp(bodies.a, a);
  stamp(bodies.b, b);
  bodies.rows = placed.rows;
  bodies.pad = static_cast<double>(placed.narrow.pad);
  bodies.translation = placed.translation;
}

void take_spheres(Front::Pair& bodies, const Collider& a, const Collider& b) {
  const auto take = [](Front::Side& side, std::span<const Spheref> spheres) {
    side.spheres.assign(spheres.begin(), spheres.end());
  };
  take(bodies.a, a.sphere_state().spheres);
  take(bodies.b, b.sphere_state().spheres);
  bodies.rounding = verdict_rounding * (largest_extent(bodies.a.spheres) + largest_extent(bodies.b.spheres) +
                                        max_norm(bodies.translation));
}

// A sum rounded up, hence no less than the exact sum: a short path after a long one would be lost in a sum rounded to
// nearest, and the next verdict would count as one of a frame in which nothing moved. The error of a sum of two doubles
// is itself a double, and is computed here.
double sum_rounded_up(double a, double b) {
  const double sum = a + b, b_of_sum = sum - a;
  const double error = (a - (sum - b_of_sum)) + (b - b_of_sum);
  // mutant front-way-rounded-up: `error > 0` -> `false`
  return error > 0 ? std::nextafter(sum, std::numeric_limits<double>::infinity()) : sum;
}

// moved(i): the distance by which the center of node i has moved. least: a length added to every node's path.
template <class Moved>
void travel(Front::Side& side, const Collider& collider, double least, std::vector<double>& way, const Moved& moved) {
  const std::span<const Spheref> spheres = collider.sphere_state().spheres;
  const SphereTree& tree = collider.tree();
  way.resize(spheres.size());
  for (std::uint32_t i = 0; i < spheres.size(); ++i)
    way[i] = (length(moved(i)) +
              // mutant front-way-of-radii: `std::abs(static_cast ... .radius))` -> `0`
              std::abs(static_cast<double>(spheres[i].radius) - static_cast<double>(side.spheres[i].radius))) *
                 (1 + 0x1p-40) +
             least;
  for (std::uint32_t i = 0; i < spheres.size(); ++i) {
    double farthest = way[i];
    // mutant front-way-of-children: `farthest = std::max(farthest, way[tree.first_child[i] + k])` -> ``
    for (std::uint32_t k = 0; k < tree.child_count[i]; ++k) farthest = std::max(farthest, way[tree.first_child[i] + k]);
    side.path_length[i] = sum_rounded_up(side.path_length[i], farthest);
  }
}

}  // namespace

void begin_travel(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed,
                  bool with_spheres) {
  stamp(bodies, a, b, placed);
  if (with_spheres) {
    take_spheres(bodies, a, b);
  } else {
    bodies.a.spheres.clear(), bodies.b.spheres.clear();
  }
  bodies.a.path_length.assign(bodies.a.spheres.size(), 0.0);
  bodies.b.path_length.assign(bodies.b.spheres.size(), 0.0);
}

void follow_travel(Front::Pair& bodies, const Collider& a, const Collider& b, const PlacedPair& placed,
                   std::vector<double>& scratch) {
  const std::span<const Spheref> now_a = a.sphere_state().spheres, now_b = b.sphere_state().spheres;
  const bool same_place = bodies.rows == placed.rows && bodies.translation == placed.translation &&
                          bodies.a.origin == a.sphere_state().origin && bodies.b.origin == b.sphere_state().origin;
  // A change of the pad counts as a change of a radius: one side counts it for both. Pads are large far from the
  // origin, and shrink when bodies come back, even if the bodies have not moved relative to each other.
  const double pad_change = std::abs(static_cast<double>(placed.narrow.pad) - bodies.pad);
  const auto has_moved = [&](const Front::Side& side, std::span<const Spheref> now) {
    return !same_place || std::memcmp(now.data(), side.spheres.data(), now.size_bytes()) != 0;
  };
  const bool moved_a = pad_change > 0 || has_moved(bodies.a, now_a), moved_b = has_moved(bodies.b, now_b);
  const double least = same_place ? 0 : placed.rounding;
  if (moved_a) {
    const Vec3 shift = a.sphere_state().origin - bodies.a.origin;
    // mutant front-pad-of-another-place: `least + pad_change` -> `least`
    travel(bodies.a, a, least + pad_change, scratch,
           [&](std::uint32_t i) { return Vec3(now_a[i].center) - Vec3(bodies.a.spheres[i].center) + shift; });
  }
  if (moved_b) {
    // The centers in a's coordinates, M c + u + origin of a, in both frames.
    const Vec3 shift = (placed.translation + a.sphere_state().origin) - (bodies.translation + bodies.a.origin);
    const std::array<Vec3, 3> then = bodies.rows;
    travel(bodies.b, b, least, scratch, [&](std::uint32_t i) {
      const Vec3 c_now(now_b[i].center), c_then(bodies.b.spheres[i].center);
      return Vec3{dot(placed.rows[0], c_now) - dot(then[0], c_then), dot(placed.rows[1], c_now) - dot(then[1], c_then),
                  dot(placed.rows[2], c_now) - dot(then[2], c_then)} +
             shift;
    });
  }
  stamp(bodies, a, b, placed);
  if (moved_a || moved_b) take_spheres(bodies, a, b);
}

}  // namespace morula::detail
