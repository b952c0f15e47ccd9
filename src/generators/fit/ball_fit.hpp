// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ball fit: one ball around the points that it must contain, with the center where it covers least empty space.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "generators/fit/outside_grid.hpp"
#include "geometry/enclosing/farthest.hpp"

namespace morula::detail {

/// Points of a region in grid coordinates.
struct GroupPoints {
  std::vector<float> x, y, z;
  std::vector<float> demand;  // weight of a point in the balance term; sums to 1

  std::size_t size() const { return x.size(); }
  PointColumns columns() const { return {x.data(), y.data(), z.data(), x.size()}; }
  Vec3f operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
  void clear() {
    x.clear();
    y.clear();
    z.clear();
    demand.clear();
  }
  void push_back(const Vec3f& p) {
    x.push_back(p.x);
    y.push_back(p.y);
    z.push_back(p.z);
  }
};

/// Distance of the farthest point; the points are at least one.
float farthest_from(const GroupPoints& points, const Vec3f& center);

/// A ball of a group. Its cost is its outside volume; volume that siblings cover already counts little.
struct GroupBall {
  Vec3f center;
  float radius = 0;
  float cost = 0;

  Spheref sphere() const { return {center, radius}; }
};
inline float distance_between(const Vec3f& a, const Vec3f& b) {
  const float x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return std::sqrt(x * x + y * y + z * z);
}

/// Returns the ball around the points with the least outside volume, found by compass search from the smallest ball's
/// center and `starts`. The ball itself must not be counted in the grid. overlap_weight: see OutsideGrid::prepare.
/// first_step, last_step: shares of the smallest ball's radius. points: at least one. Cost: about thirty evaluations of
/// the grid.
GroupBall fit_ball(OutsideGrid& grid, const GroupPoints& points, std::span<const Vec3f> starts, float overlap_weight,
                   float first_step, float last_step = 0.02F);

}  // namespace morula::detail
