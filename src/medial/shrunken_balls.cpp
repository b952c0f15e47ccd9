// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "medial/shrunken_balls.hpp"

#include <algorithm>
#include <cassert>
#include <optional>

#include "parallel/float_environment.hpp"

namespace morula::detail {
namespace {

// Round bodies are made of facets, and no ball that is tangent to one of them off its middle has room: where facets
// meet at 15°, strict balls have half the radius of the round body. So a ball is finished when surface is less than
// this share of its radius inside; then it makes room for that surface, and touches near its point instead of at it.
constexpr double almost = 0.1;
constexpr int most_rooms = 3;           // steps that make room
constexpr double enough_room = 1e-3;    // share of the radius: less is not worth a step
constexpr double nothing = 1e-9;        // share of the radius that counts as rounding
constexpr double smallest_ball = 1e-9;  // share of the diagonal: smaller balls shrink towards nothing, on an edge
constexpr int most_steps = 50;

/// Moves the center away from the nearest surface, as long as the ball grows: by half of the amount by which p is
/// farther than that surface.
Sphere made_room(const SignedDistance& shape, const Vec3& p, Vec3 center, SignedDistance::Result at) {
  for (int step = 0; step < most_rooms; ++step) {
    const double gap = distance(center, p) + at.distance;
    if (gap <= -enough_room * at.distance) break;
    const Vec3 moved = center + (0.5 * gap / -at.distance) * (center - at.closest.point);
    const SignedDistance::Result there =
        shape.at(moved, std::min(distance(moved, p), distance(moved, at.closest.point)));
    if (!(there.distance < at.distance)) break;
    center = moved;
    at = there;
  }
  return {center, -at.distance};
}

/// The ball that touches the surface at p from inside, made smaller until no surface is in it: each step leads to the
/// ball that touches at p and goes through the surface point nearest to the last center.
std::optional<Sphere> shrink(const SignedDistance& shape, const Vec3& p, const Vec3& n, double diagonal) {
  if (!is_finite(p) || !(squared_length(n) > 0.5)) return {};
  double radius = 0.5 * diagonal;
  for (int step = 0; step < most_steps; ++step) {
    const Vec3 center = p - radius * n;
    std::optional<ClosestFacetPoint> q = shape.bvh().closest_point(center, radius * (1.0 - almost));
    if (!q) {
      const SignedDistance::Result at = shape.at(center, radius);
      if (at.distance < 0) return made_room(shape, p, center, at);
      // The center is outside, through a thin part; or the normal points inwards, and no ball touches.
      if (!(at.distance < radius * (1.0 - nothing))) return {};
      q = at.closest;
    }
    const Vec3 from_q_to_p = p - q->point;
    const double rise = dot(n, from_q_to_p);
    const double next = squared_length(from_q_to_p) / (2.0 * rise);
    // The ball gets smaller, in real numbers; but not if p itself is off the surface by rounding and nearest.
    if (!(rise > 0) || !(next < radius) || next < smallest_ball * diagonal) return {};
    radius = next;
  }
  return {};
}

bool touches(const Sphere& ball, const Vec3& p, const Vec3& n) {
  constexpr double far = 0.003;       // share of the radius
  constexpr double same_way = 0.998;  // cosine
  const Vec3 from_center = p - ball.center;
  const double away = length(from_center);
  return std::abs(away - ball.radius) <= far * ball.radius && dot(from_center, n) >= same_way * away;
}

/// The volume of the box that unit vectors span: near 0 if they lie in one plane.
double spread(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::abs(dot(a, cross(b, c)));
}

/// A ball that the last point touches as it touches another one, all three from different sides: this part of the body
/// is round. Points around a tube see its axis from one plane, and wide balls are touched, nearly, by all points near
/// the one that they were found at. balls: of all points except the last.
const Sphere* known_at(std::span<const std::optional<Sphere>> balls, std::span<const Vec3> points,
                       std::span<const Vec3> normals) {
  // mutant shared-balls-of-tubes: `0.1` -> `0`
  constexpr double enough = 0.1;
  const std::size_t last = balls.size();
  for (std::size_t a = 0; a < last; ++a) {
    if (!balls[a] || !touches(*balls[a], points[last], normals[last])) continue;
    for (std::size_t b = a + 1; b < last; ++b)
      if (balls[b] && spread(normals[last], normals[a], normals[b]) >= enough &&
          touches(*balls[b], points[last], normals[last]))
        return &*balls[a];
  }
  return nullptr;
}

}  // namespace

std::vector<Sphere> shrunken_balls(const SignedDistance& shape, std::span<const Vec3> points,
                                   std::span<const Vec3> normals, BallSharing sharing, Workers& workers) {
  const StandardFloats standard;
  assert(points.size() == normals.size());
  const double diagonal = shape.bvh().bounding_box().diagonal();
  std::vector<std::optional<Sphere>> found(points.size());
  parallel_for(workers, points.size(), 32, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Sphere* known = nullptr;
      if (sharing == BallSharing::on_round_parts)
        known = known_at(std::span(found).subspan(begin, i - begin), points.subspan(begin), normals.subspan(begin));
      found[i] = known != nullptr ? *known : shrink(shape, points[i], normals[i], diagonal);
    }
  });
  std::vector<Sphere> balls;
  for (const std::optional<Sphere>& ball : found)
    if (ball) balls.push_back(*ball);
  return balls;
}

}  // namespace morula::detail
