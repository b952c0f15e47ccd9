// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "surface/haptic/tool_neighbors.hpp"

#include <algorithm>
#include <cmath>
#include <morula/geometry/scale.hpp>

namespace morula::detail {
namespace {

double distance_to_segment(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 along = to - from;
  const double squared = squared_length(along);
  const double share = squared > 0 ? std::clamp(dot(p - from, along) / squared, 0.0, 1.0) : 0;
  return distance(p, from + share * along);
}

// Heights along the direction relative to `from`: their rounding is below 2^-50 of the coordinates.
bool separates(const Vec3& direction, const Triangle& t, const Vec3& from, const Vec3& to, double least) {
  const Vec3 way = to - from;
  double highest = -std::numeric_limits<double>::infinity(), size = max_norm(way);
  for (const Vec3& corner : t) {
    const Vec3 relative = corner - from;
    highest = std::max(highest, dot(direction, relative));
    size = std::max(size, max_norm(relative));
  }
  // mutant haptic-tool-one-end: `std::min(0.0, dot(direction, way))` -> `0.0`
  const double gap = std::min(0.0, dot(direction, way)) - highest;
  return gap * (1 - 0x1p-50) > least + 0x1p-46 * size + 0x1p-50 * max_norm(from);
}

}  // namespace

KeptDistances kept_of_ball(double radius, double skin, double ahead) {
  KeptDistances kept(radius, skin);
  kept.touching += ahead, kept.core = radius;
  return kept;
}

// The distance along the segment is convex, so bisection by the sign of its derivative finds the nearest points.
bool is_proven_apart(const Triangle& t, const Vec3& from, const Vec3& to, double least) {
  const Vec3 way = to - from;
  const auto direction_at = [&](double share) {
    const Vec3 p = from + share * way;
    return normalized(p - closest_point(t, p).point, Vec3{});
  };
  const Vec3 first = direction_at(0);
  if (separates(first, t, from, to, least) || separates(direction_at(1), t, from, to, least)) return true;
  double lower = 0, upper = 1;
  for (int k = 0; k < 16; ++k) {
    const double share = 0.5 * (lower + upper);
    const Vec3 direction = direction_at(share);
    if (separates(direction, t, from, to, least)) return true;
    (dot(direction, way) < 0 ? lower : upper) = share;
  }
  return false;
}

void ToolNeighbors::clear() {
  for (Ball& ball : balls_) ball.slack = -1;
}

bool ToolNeighbors::gather(const Collider& body, const ToolShape& shape, double skin, const std::vector<Vec3>& centers,
                           const std::vector<Vec3>& to) {
  balls_.resize(shape.size());
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    Ball& ball = balls_[k];
    const double ahead = lookahead(shape.radius(k), skin), inner = ahead * (1 - 0x1p-30);
    const bool is_short = squared_distance(ball.from, ball.to) <= 16 * ahead * ahead;
    // mutant haptic-tool-old-facets: `distance_to_segment(to[k], ball.from, ball.to) <= inner` -> `true`
    if (ball.slack >= 0 && (is_short || centers[k] == ball.from) &&
        distance_to_segment(centers[k], ball.from, ball.to) <= inner &&
        distance_to_segment(to[k], ball.from, ball.to) <= inner)
      continue;
    ball.from = centers[k], ball.to = to[k], ball.slack = -1;
    const Capsule capsule{ball.from, ball.to, KeptDistances(shape.radius(k), skin).touching + 2 * ahead};
    const Touch& found = touch_.run(body, capsule, {.collect_all = true});
    sphere_tests += found.sphere_tests, facet_tests += found.facet_tests;
    if (!found.status) return false;
    ball.slack = ahead;
    ball.near.clear();
    for (const TouchingFacet& facet : found.facets)
      ball.near.push_back({facet.point.facet, body.triangle(facet.point.facet)});
  }
  return true;
}

void ToolNeighbors::find_contacts(const ToolShape& shape, double skin, const std::vector<Vec3>& centers,
                                  std::vector<BallContact>& contacts) {
  contacts.clear();
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    if (balls_[k].near.empty()) continue;
    const KeptDistances kept = kept_of_ball(shape.radius(k), skin, lookahead(shape.radius(k), skin));
    detail::find_contacts(balls_[k].near, centers[k], kept, found_);
    for (const ProxyContact& at : found_) contacts.push_back({static_cast<std::uint32_t>(k), at});
  }
}

double ToolNeighbors::free_share(const ToolShape& shape, double skin, double sag, const std::vector<Vec3>& centers,
                                 const std::vector<Vec3>& ends) const {
  double share = 1;
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    KeptDistances kept = kept_of_ball(shape.radius(k), skin);
    if (sag > skin / 64) kept.stop += sag;
    share = std::min(share, detail::free_share(balls_[k].near, centers[k], ends[k] - centers[k], kept));
  }
  return share;
}

bool ToolNeighbors::is_proven_free(const ToolShape& shape, double skin, double sag, const std::vector<Vec3>& centers,
                                   const std::vector<Vec3>& ends) const {
  for (std::size_t k = 0; k < balls_.size(); ++k) {
    const double radius = shape.radius(k), way = distance(centers[k], ends[k]);
    for (const NearFacet& facet : balls_[k].near) {
      const double now = std::sqrt(closest_point(facet.corners, centers[k]).squared_distance);
      const double least = radius + std::min(skin, now - radius) / 2 + sag;
      if (now - way > least + skin) continue;
      // mutant haptic-tool-unproven: `!is_proven_apart(facet.corners, centers[k], ends[k], least)` -> `false`
      if (!(now > radius) || !is_proven_apart(facet.corners, centers[k], ends[k], least)) return false;
    }
  }
  return true;
}

}  // namespace morula::detail
