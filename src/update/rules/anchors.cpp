// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rules/anchors.hpp"

#include <cmath>

#include "update/rules/anchor_choice.hpp"

namespace morula::detail {
namespace {

Vec3f position(const LocalPoint& p) {
  return {p.x, p.y, p.z};
}

// Orthonormal axes that turn with three points; total, and the same for the same points. Where they do not tell a
// direction, some perpendicular one is as good: then all anchors lie on a line (or in a point), and what matters of the
// remainder is its share along the line and its length.
struct TurnedAxes {
  Vec3f a, b, c;
};
TurnedAxes axes_of(const Vec3f& p, const Vec3f& q, const Vec3f& r) {
  const Vec3f a = normalized(q - p), side = r - p;
  Vec3f b = side - a * dot(a, side);
  constexpr float parallel = 1e-12f;
  if (!(squared_length(b) > parallel * squared_length(side))) {
    const Vec3f size{std::abs(a.x), std::abs(a.y), std::abs(a.z)};
    const Vec3f least = size.x <= size.y && size.x <= size.z ? Vec3f{1, 0, 0}
                        : size.y <= size.z                   ? Vec3f{0, 1, 0}
                                                             : Vec3f{0, 0, 1};
    b = cross(a, least);
  }
  // Once more: where b was a small difference, rounding has left it a share along a, and then distances would change.
  b = normalized(b, {0, 1, 0});
  b = normalized(b - a * dot(a, b), {0, 1, 0});
  return {a, b, cross(a, b)};
}
Vec3f carried(const CenterTie& tie, std::span<const LocalPoint> points) {
  const TurnedAxes f =
      axes_of(position(points[tie.axes[0]]), position(points[tie.axes[1]]), position(points[tie.axes[2]]));
  return f.a * tie.in_axes.x + f.b * tie.in_axes.y + f.c * tie.in_axes.z;
}

}  // namespace

void Anchors::tie(const Vec3f& center, float radius, std::span<const LocalPoint> rest_points,
                  std::span<const std::uint32_t> candidates) {
  CenterTie tie;
  tie.rest_center = center;
  const AnchorChoice choice = choose_anchors(Vec3(center), static_cast<double>(radius), rest_points, candidates);
  tie.begin = static_cast<std::uint32_t>(points_.size());
  points_.insert(points_.end(), choice.points.begin(), choice.points.end());
  for (const double w : choice.weights) weights_.push_back(static_cast<float>(w));
  tie.end = static_cast<std::uint32_t>(points_.size());
  tie.degenerate = choice.degenerate;
  tie.axes = choice.axes;
  tie.rest_sum = weighted_sum(tie, rest_points);

  if (!choice.reproduces && !choice.points.empty()) {
    const Vec3 remainder = Vec3(center) - Vec3(tie.rest_sum);
    tie.carries = length(remainder) > 1e-7 * static_cast<double>(radius);
    const TurnedAxes f = axes_of(position(rest_points[tie.axes[0]]), position(rest_points[tie.axes[1]]),
                                 position(rest_points[tie.axes[2]]));
    tie.in_axes = Vec3f(Vec3{dot(remainder, Vec3(f.a)), dot(remainder, Vec3(f.b)), dot(remainder, Vec3(f.c))});
    tie.rest_carried = carried(tie, rest_points);
  }
  ties_.push_back(tie);
}

void Anchors::append(const Anchors& others) {
  const auto offset = static_cast<std::uint32_t>(points_.size());
  for (CenterTie tie : others.ties_) {
    tie.begin += offset;
    tie.end += offset;
    ties_.push_back(tie);
  }
  points_.insert(points_.end(), others.points_.begin(), others.points_.end());
  weights_.insert(weights_.end(), others.weights_.begin(), others.weights_.end());
}

Vec3f Anchors::weighted_sum(const CenterTie& tie, std::span<const LocalPoint> points) const noexcept {
  // Two sums, so that an addition need not wait for the one before.
  Float4 even(0.0f), odd(0.0f);
  std::uint32_t i = tie.begin;
  for (; i + 1 < tie.end; i += 2) {
    even = even + Float4(weights_[i]) * Float4::load(points[points_[i]]);
    odd = odd + Float4(weights_[i + 1]) * Float4::load(points[points_[i + 1]]);
  }
  if (i < tie.end) even = even + Float4(weights_[i]) * Float4::load(points[points_[i]]);
  const Float4 sum = even + odd;
  LocalPoint result;
  sum.store(result);
  return position(result);
}

Vec3f Anchors::center(std::size_t k, std::span<const LocalPoint> points) const noexcept {
  const CenterTie& tie = ties_[k];
  Vec3f center = tie.rest_center + (weighted_sum(tie, points) - tie.rest_sum);
  if (tie.carries) center = center + (carried(tie, points) - tie.rest_carried);
  return center;
}

}  // namespace morula::detail
