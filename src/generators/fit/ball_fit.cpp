// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/ball_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "generators/fit/compass_search.hpp"

namespace morula::detail {
namespace {

constexpr float infinite_cost = std::numeric_limits<float>::infinity();
// A small share of a ball's whole volume joins its cost, so that the smaller of two balls without empty space is
// better.
constexpr float whole_volume_share = 0.001F;
constexpr float unit_ball_volume = static_cast<float>(4.0 / 3.0 * std::numbers::pi);

float cube(float x) {
  return x * x * x;
}

// Near the center of the smallest ball [badoiu2003]: steps towards the farthest point, shorter and shorter.
Vec3f near_smallest_center(const GroupPoints& points) {
  Box box;
  for (std::size_t i = 0; i < points.size(); ++i) box.add({points.x[i], points.y[i], points.z[i]});
  const Vec3 middle = box.center();
  Vec3f center{static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z)};
  constexpr int steps = 16;
  for (int step = 0; step < steps; ++step) {
    const std::size_t at = farthest_kernels().from(points.columns(), center);
    const float share = 1.0F / static_cast<float>(step + 3);
    center = center + (points[at] - center) * share;
  }
  return center;
}

}  // namespace

float farthest_from(const GroupPoints& points, const Vec3f& center) {
  return std::sqrt(farthest_kernels().squared_distance(points.columns(), center));
}

GroupBall fit_ball(OutsideGrid& grid, const GroupPoints& points, std::span<const Vec3f> starts, float overlap_weight,
                   float first_step, float last_step) {
  constexpr float least_radius = 1e-4F;  // a point's ball
  const Vec3f middle = near_smallest_center(points);
  const float smallest = std::max(least_radius, farthest_from(points, middle));
  // A ball whose center is a step away reaches as far as that from here, and is larger by as much at most.
  const float longest_step = first_step * smallest, of_steps = 2.02F;
  grid.prepare(middle, smallest + of_steps * longest_step, overlap_weight);

  GroupBall about{middle, smallest, infinite_cost};  // the best so far; the next evaluations are a step from it
  const auto evaluate = [&](const Vec3f& center, float enough) {
    const float radius = std::max(least_radius, farthest_from(points, center));
    if (!grid.is_inside(center, radius)) return GroupBall{center, radius, infinite_cost};
    if (!grid.is_prepared(center, radius)) {
      const Vec3f step = center - about.center;
      const float length = std::sqrt(step.x * step.x + step.y * step.y + step.z * step.z);
      if (length < 1.01F * longest_step) grid.prepare(about.center, about.radius + of_steps * length, overlap_weight);
      if (!grid.is_prepared(center, radius)) grid.prepare(center, radius + of_steps * longest_step, overlap_weight);
    }
    const float extra = whole_volume_share * unit_ball_volume * cube(radius);
    const GroupBall ball{center, radius, grid.cost(center, radius, enough - extra) + extra};
    if (ball.cost < about.cost) about = ball;
    return ball;
  };
  GroupBall best = evaluate(middle, infinite_cost);
  for (const Vec3f& start : starts)
    if (const GroupBall other = evaluate(start, best.cost); other.cost < best.cost) best = other;
  return compass_search(best, smallest, first_step, last_step, evaluate);
}

}  // namespace morula::detail
