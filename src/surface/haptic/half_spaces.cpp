// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/half_spaces.hpp"

#include <algorithm>
#include <cmath>

namespace morula::detail {
namespace {

/// Planes by their numbers.
struct PlaneSet {
  std::array<std::uint32_t, 4> plane{};
  std::size_t size = 0;
};

/// Weights with which goal + sum of weight × normal lies in all planes of the set. False for planes that are parallel
/// up to 1e-7, or three normals as near to one plane.
bool weights_in_planes(const Vec3& goal, std::span<const KeptSide> sides, const PlaneSet& set,
                       std::array<double, 3>& weight) {
  constexpr double least_determinant = 1e-14;
  std::array<double, 3> miss{};
  for (std::size_t k = 0; k < set.size; ++k)
    miss[k] = sides[set.plane[k]].offset - dot(sides[set.plane[k]].normal, goal);
  if (set.size == 1) {
    weight[0] = miss[0];
    return true;
  }
  const auto product = [&](std::size_t i, std::size_t j) {
    return dot(sides[set.plane[i]].normal, sides[set.plane[j]].normal);
  };
  if (set.size == 2) {
    // 1 - c² as the square of a cross product keeps its digits for small angles.
    const double c = product(0, 1);
    const double determinant = squared_length(cross(sides[set.plane[0]].normal, sides[set.plane[1]].normal));
    if (!(determinant > least_determinant)) return false;
    weight[0] = (miss[0] - c * miss[1]) / determinant;
    weight[1] = (miss[1] - c * miss[0]) / determinant;
    return true;
  }
  // The point of three planes, then its weights by the reciprocal basis.
  const Vec3 &a = sides[set.plane[0]].normal, &b = sides[set.plane[1]].normal, &c = sides[set.plane[2]].normal;
  const double determinant = dot(a, cross(b, c));
  if (!(determinant * determinant > least_determinant)) return false;
  const Vec3 bc = cross(b, c) / determinant, ca = cross(c, a) / determinant, ab = cross(a, b) / determinant;
  const Vec3 move = miss[0] * bc + miss[1] * ca + miss[2] * ab;
  weight = {dot(move, bc), dot(move, ca), dot(move, ab)};
  return true;
}

Vec3 moved(const Vec3& goal, std::span<const KeptSide> sides, const PlaneSet& set,
           const std::array<double, 3>& weight) {
  Vec3 point = goal;
  for (std::size_t k = 0; k < set.size; ++k) point += weight[k] * sides[set.plane[k]].normal;
  return point;
}

/// The nearest point for at most four planes, among all subsets that contain the last one. Returns false if none is on
/// the kept side of all.
bool nearest_of_few(const Vec3& goal, std::span<const KeptSide> sides, const PlaneSet& planes, double tolerance,
                    PlaneSet& best, NearestKept& result) {
  double least = -1;
  for (std::uint32_t chosen = 0; chosen < 1u << (planes.size - 1); ++chosen) {
    PlaneSet set;
    for (std::size_t k = 0; k + 1 < planes.size; ++k)
      if ((chosen >> k & 1u) != 0) set.plane[set.size++] = planes.plane[k];
    set.plane[set.size++] = planes.plane[planes.size - 1];
    std::array<double, 3> weight{};
    if (set.size > 3 || !weights_in_planes(goal, sides, set, weight)) continue;
    bool is_kept = true;
    for (std::size_t k = 0; k < set.size; ++k) is_kept = is_kept && weight[k] >= 0;
    if (!is_kept) continue;
    const Vec3 point = moved(goal, sides, set, weight);
    for (std::size_t k = 0; k < planes.size; ++k) {
      const KeptSide& side = sides[planes.plane[k]];
      is_kept = is_kept && dot(side.normal, point) >= side.offset - tolerance;
    }
    const double squared = squared_distance(point, goal);
    if (!is_kept || (least >= 0 && squared >= least)) continue;
    least = squared;
    best = set;
    result.point = point;
    result.weight = weight;
  }
  return least >= 0;
}

}  // namespace

// The planes that hold the nearest point are at most three. Adding the plane that the point violates most and solving
// for these and the new one moves the point away from the goal every time, so no set comes again, up to rounding.
NearestKept nearest_kept(const Vec3& goal, std::span<const KeptSide> sides, double tolerance) {
  constexpr int most_changes = 64;
  NearestKept result;
  result.point = goal;
  PlaneSet held;
  for (int changes = 0;; ++changes) {
    double worst = tolerance;
    std::uint32_t plane = 0;
    bool found = false;
    for (std::uint32_t k = 0; k < sides.size(); ++k) {
      const double miss = sides[k].offset - dot(sides[k].normal, result.point);
      if (miss <= worst) continue;
      worst = miss, plane = k, found = true;
    }
    if (!found) break;
    PlaneSet tried = held;
    tried.plane[tried.size++] = plane;
    if (changes == most_changes || !nearest_of_few(goal, sides, tried, tolerance, held, result)) {
      NearestKept none;
      none.point = goal;
      none.exists = false;
      return none;
    }
  }
  result.active_count = held.size;
  std::copy_n(held.plane.begin(), std::min<std::size_t>(held.size, 3), result.active.begin());
  return result;
}

}  // namespace morula::detail
