// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <cassert>
#include <morula/geometry/scale.hpp>
#include <morula/medial/medial_balls.hpp>
#include <optional>
#include <stdexcept>

#include "medial/ball_neighbors.hpp"
#include "medial/voronoi_balls.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
using namespace detail;
namespace {

// Round bodies are made of facets, and no ball that is tangent to one of them off its middle has room: where facets
// meet at 15°, strict balls have half the radius of the body that is meant. So a ball is done when surface is less than
// this share of its radius inside; then it makes room for that surface, and touches near its point instead of at it.
constexpr double almost = 0.1;
constexpr int most_rooms = 3;           // steps that make room
constexpr double enough_room = 1e-3;    // share of the radius: less is not worth a step
constexpr double nothing = 1e-9;        // share of the radius that is taken for rounding
constexpr double smallest_ball = 1e-9;  // of the diagonal: smaller ones are on their way to nothing, on an edge
constexpr int most_steps = 50;
constexpr std::size_t neighbor_count = 8;

/// Away from the nearest surface, as long as the ball grows: half of what p is farther than that.
Sphere made_room(const SignedDistance& shape, const Vec3& p, Vec3 center, SignedDistance::Result at) {
  for (int step = 0; step < most_rooms; ++step) {
    const double gap = distance(center, p) + at.distance;
    if (gap <= -enough_room * at.distance) break;
    const Vec3 moved = center + (0.5 * gap / -at.distance) * (center - at.closest.point);
    const SignedDistance::Result there = shape.at(moved);
    if (!(there.distance < at.distance)) break;
    center = moved;
    at = there;
  }
  return {center, -at.distance};
}

/// The ball that touches the surface at p from inside, made smaller until no surface is in it: each step leads to the
/// ball that touches at p and goes through the surface point nearest to the last centre.
std::optional<Sphere> shrink(const SignedDistance& shape, const Vec3& p, const Vec3& n, double diagonal) {
  if (!is_finite(p) || !(squared_length(n) > 0.5)) return {};
  double radius = 0.5 * diagonal;
  for (int step = 0; step < most_steps; ++step) {
    const Vec3 center = p - radius * n;
    std::optional<ClosestFacetPoint> q = shape.bvh().closest_point(center, radius * (1.0 - almost));
    if (!q) {
      const SignedDistance::Result at = shape.at(center);
      if (at.distance < 0) return made_room(shape, p, center, at);
      // Outside, through something thin; or the normal points inwards, and there is nothing to touch.
      if (!(at.distance < radius * (1.0 - nothing))) return {};
      q = at.closest;
    }
    const Vec3 from_q_to_p = p - q->point;
    const double rise = dot(n, from_q_to_p);
    const double next = squared_length(from_q_to_p) / (2.0 * rise);
    // Smaller, in real numbers; not where p itself is off the surface by rounding and nearest.
    if (!(rise > 0) || !(next < radius) || next < smallest_ball * diagonal) return {};
    radius = next;
  }
  return {};
}

}  // namespace

MedialBalls shrinking_balls(const SignedDistance& shape, std::span<const Vec3> points, std::span<const Vec3> normals,
                            Workers& workers) {
  const StandardFloats standard;
  assert(points.size() == normals.size());
  const double diagonal = shape.bvh().bounding_box().diagonal();
  std::vector<std::optional<Sphere>> found(points.size());
  parallel_for(workers, points.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) found[i] = shrink(shape, points[i], normals[i], diagonal);
  });
  MedialBalls medial;
  for (const std::optional<Sphere>& ball : found) {
    if (ball) medial.balls.push_back(*ball);
  }
  connect_overlapping(medial, neighbor_count, workers);
  return medial;
}

MedialBalls voronoi_balls(const SignedDistance& shape, std::span<const Vec3> samples) {
  const StandardFloats standard;
  Box box;
  for (const Vec3& sample : samples) {
    if (is_finite(sample)) box.add(sample);
  }
  if (!box.is_empty() && !(has_usable_scale({box.lower, 0}) && has_usable_scale({box.upper, 0})))
    throw std::invalid_argument("voronoi_balls: a sample has a number beyond 1e30");
  MedialBalls medial;
  if (box.is_empty()) return medial;
  VoronoiBalls voronoi(box, shape);
  voronoi.insert(samples);

  const std::vector<VoronoiBall>& all = voronoi.balls();
  const auto is_medial = [&](std::uint32_t slot) { return all[slot].alive && voronoi.side(slot) < 0; };
  std::vector<std::uint32_t> number(all.size(), no_ball);
  for (std::uint32_t slot = 0; slot < all.size(); ++slot) {
    if (!is_medial(slot)) continue;
    number[slot] = static_cast<std::uint32_t>(medial.balls.size());
    medial.balls.push_back(all[slot].ball);
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
  for (std::uint32_t slot = 0; slot < all.size(); ++slot) {
    if (number[slot] == no_ball) continue;
    for (const std::uint32_t neighbor : all[slot].neighbors) {
      if (neighbor != no_ball && number[neighbor] != no_ball) pairs.emplace_back(number[slot], number[neighbor]);
    }
  }
  set_neighbors(medial, std::move(pairs));
  return medial;
}

}  // namespace morula
