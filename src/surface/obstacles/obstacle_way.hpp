// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The path of a vertex or a facet past an obstacle, and the time up to which it is proven to stay apart.
#pragma once

#include <algorithm>
#include <array>
#include <concepts>
#include <limits>
#include <morula/surface/obstacles.hpp>

#include "collide/facets/world_facets.hpp"
#include "collide/shapes/placed_shapes.hpp"

namespace morula::detail {

inline bool is_usable(const DistanceField& field) {
  return field.value && field.lipschitz > 0 && std::isfinite(field.lipschitz) && field.tolerance >= 0 &&
         std::isfinite(field.tolerance);
}

/// A distance field as a shape: it has the functions of the shapes of placed_shapes.hpp, computed from its values and
/// from the rate at which they change.
class PlacedField {
 public:
  explicit PlacedField(const DistanceField& field) : field_(&field) {}

  double lipschitz() const { return field_->lipschitz; }
  double distance_at(const Vec3& x) const { return field_->value(x); }
  /// A bound for points within a distance of x, whose coordinates are off by about 2^-50 of themselves.
  double bound(const Sphere& s) const {
    return field_->value(s.center) - field_->lipschitz * (s.radius * (1 + 0x1p-48) + 0x1p-48 * max_norm(s.center));
  }
  double bound(const Vec3& center, const Vec3& half) const { return bound(Sphere{center, scaled_length(half)}); }

  /// The least value on a facet within the tolerance, or within half of its excess over `margin`: the facet is divided
  /// into quarters, at whose centers the field is evaluated. A quarter is done when it cannot be so much below the
  /// least known value. No value in a done quarter is less than the final least value less that allowance, since the
  /// allowance falls more slowly than the value.
  FoundOnShape look_at(const Triangle& t, double margin) const {
    const double edge = std::max({length(t[1] - t[0]), length(t[2] - t[1]), length(t[0] - t[2])});
    const double tolerance = field_->tolerance > 0 ? field_->tolerance : 0.125 * edge * field_->lipschitz;
    FoundOnShape found;
    bool is_number = true;
    const auto evaluate = [&](const Barycentric& b) {
      const Vec3 x = at_barycentric(t, b);
      const double value = field_->value(x);
      is_number = is_number && !std::isnan(value);
      if (!(value >= found.distance)) found.distance = value, found.barycentric = b, found.point = x;
      return value;
    };
    constexpr std::size_t most_halvings = 16;
    struct Part {
      std::array<Barycentric, 3> corners;
      std::size_t halvings;
    };
    std::array<Part, 3 * most_halvings + 4> stack;
    std::size_t count = 0;
    stack[count++] = {{Barycentric{1, 0, 0}, Barycentric{0, 1, 0}, Barycentric{0, 0, 1}}, 0};
    for (const Barycentric& corner : stack[0].corners) evaluate(corner);
    while (count > 0) {
      const Part part = stack[--count];
      const auto& [a, b, c] = part.corners;
      const auto between = [](const Barycentric& p, const Barycentric& q) {
        return Barycentric{(p[0] + q[0]) * 0.5, (p[1] + q[1]) * 0.5, (p[2] + q[2]) * 0.5};
      };
      const Barycentric middle{(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3};
      const double value = evaluate(middle);
      const Vec3 x = at_barycentric(t, middle);
      double radius = 0;
      for (const Barycentric& corner : part.corners) radius = std::max(radius, length(at_barycentric(t, corner) - x));
      const double lower = value - field_->lipschitz * (radius * (1 + 0x1p-48) + 0x1p-47 * max_norm(x));
      const double allowed = std::max(tolerance, 0.5 * (found.distance - margin));
      if (!is_number) break;
      if (lower >= found.distance - allowed || field_->lipschitz * radius <= tolerance ||
          part.halvings == most_halvings) {
        found.lower = std::min(found.lower, lower);
        continue;
      }
      const Barycentric ab = between(a, b), bc = between(b, c), ca = between(c, a);
      stack[count++] = {{a, ab, ca}, part.halvings + 1};
      stack[count++] = {{ab, b, bc}, part.halvings + 1};
      stack[count++] = {{ca, bc, c}, part.halvings + 1};
      stack[count++] = {{ab, bc, ca}, part.halvings + 1};
    }
    if (!is_number) found.distance = found.lower = std::numeric_limits<double>::quiet_NaN();
    return found;
  }

  Vec3 normal_at(const Vec3& x, const Triangle&) const {
    if (field_->gradient) return normalized(field_->gradient(x), {0, 0, 1});
    const double size = std::max(max_norm(x), field_->tolerance), h = 0x1p-17 * (size > 0 ? size : 1);
    const auto along = [&](const Vec3& step) { return field_->value(x + step) - field_->value(x - step); };
    return normalized(Vec3{along({h, 0, 0}), along({0, h, 0}), along({0, 0, h})}, {0, 0, 1});
  }

 private:
  const DistanceField* field_;
};

template <class Shape>
inline constexpr bool is_field = std::same_as<Shape, PlacedField>;

/// The point of a vertex or a facet that is nearest to a shape. `lower` is below all of its signed distances.
template <class Shape>
FoundOnShape nearest_on(const Shape& shape, std::span<const Vec3> points, double margin) {
  if (points.size() == 1) {
    FoundOnShape found;
    found.barycentric = {1, 0, 0};
    found.point = points[0];
    found.distance = shape.distance_at(points[0]);
    found.lower = is_field<Shape> ? found.distance : shape.bound(Sphere{points[0], 0});
    return found;
  }
  const Triangle t{points[0], points[1], points[2]};
  if constexpr (is_field<Shape>) {
    return shape.look_at(t, margin);
  } else {
    return shape.look_at(t);
  }
}

template <class Shape>
Vec3 normal_of(const Shape& shape, std::span<const Vec3> points, const Vec3& at) {
  return shape.normal_at(at, {points[0], points[points.size() == 3 ? 1 : 0], points[points.size() == 3 ? 2 : 0]});
}

/// Vertices that go from `from` to `to` on straight lines, in time 0 to 1, while the shape stands still.
template <class Shape>
class ObstacleWay {
 public:
  using Points = std::array<Vec3, 3>;

  ObstacleWay(const Shape& shape, const Points& from, const Points& to, std::size_t size, double margin, double reach)
      : shape_(shape), from_(from), to_(to), size_(size), margin_(margin), reach_(reach) {
    // mutant obstacle-speed: `std::max(speed_, scaled_length(to_[i] - from_[i]))` -> `scaled_length(to_[i] - from_[i])`
    for (std::size_t i = 0; i < size_; ++i) speed_ = std::max(speed_, scaled_length(to_[i] - from_[i]));
  }

  /// The first time that is not proven to be free of impacts; more than 1 when all times are.
  double advance() const {
    double time = 0, ahead = 1;
    for (int steps = 0; steps < most_steps; ++steps) {
      const Points here = at(time);
      const FoundOnShape nearest = nearest_on(shape_, first(here), margin_);
      if (!(nearest.distance > margin_)) return time;
      double reached = safe_time(nearest.lower, time);
      if constexpr (!is_field<Shape>) {
        const Vec3 direction = normal_of(shape_, first(here), nearest.point);
        reached = std::max(reached, last_apart(direction, time));
        const double end = std::min(1.0, time + ahead);
        if (reached <= 1 && is_apart(direction, here, time, end)) {
          reached = std::max(reached, end);
          ahead *= 2;
        } else {
          ahead /= 8;
        }
      } else {
        ahead = 0;
      }
      if (reached >= 1) return never;
      if (!(reached - time >= least_gain) && ahead < least_gain) return std::max(time, reached);
      time = std::max(time, reached);
    }
    return time;
  }

 private:
  static constexpr double never = std::numeric_limits<double>::infinity();
  static constexpr int most_steps = 1000;
  /// A step that gains less time than this counts as none.
  static constexpr double least_gain = 0x1p-24;

  std::span<const Vec3> first(const Points& points) const { return std::span(points).first(size_); }
  Points at(double time) const {
    Points p;
    for (std::size_t i = 0; i < size_; ++i) p[i] = from_[i] + (to_[i] - from_[i]) * time;
    return p;
  }

  /// No point of the feature goes farther than its fastest vertex, and signed distances change no faster than their
  /// points move, or a field by its constant times that. Positions at a time are off by about 2^-51 of the reach.
  double safe_time(double lower, double time) const {
    double constant = 1;
    if constexpr (is_field<Shape>) constant = shape_.lipschitz();
    // mutant obstacle-gap: `(lower - margin_)` -> `2 * (lower - margin_)`
    const double gap = (lower - margin_) - constant * 0x1p-46 * reach_;
    if (!(gap > 0)) return time;
    return time + gap / (constant * speed_) * (1 - 0x1p-40);
  }

  /// The lower bound that a gap along a direction has to exceed: the margin, plus an allowance for rounding. Heights
  /// are sums of three products, positions off by 2^-51: all of it below 2^-48 |direction|_1 reach, and |direction|_1
  /// is at most 2.
  double allowance(const Vec3& direction) const {
    return margin_ * length(direction) * (1 + 0x1p-50) + 0x1p-46 * reach_ + 0x1p-1000;
  }

  /// The last time, from `time` on, up to which the whole feature is above the shape along the direction.
  ///
  /// The height of a vertex above the shape's farthest point is linear in time: positive at two times, it is so between
  /// them. A feature is the hull of its vertices.
  double last_apart(const Vec3& direction, double time) const requires(!is_field<Shape>) {
    const double top = shape_.support(direction) + allowance(direction);
    double last = never;
    for (std::size_t i = 0; i < size_; ++i) {
      const double start = dot(direction, from_[i]) - top, there = dot(direction, to_[i]) - top;
      const double here = start + (there - start) * time;
      if (!(here > 0)) return time;
      if (there > 0) continue;
      // The quotient is off by 2^-51, in which time no gap shrinks by more than the allowance has room for.
      last = std::min(last, time + (1 - time) * (here / (here - there)));
    }
    return last;
  }

  /// Whether the two are apart from `begin` to `end` by a direction that turns from m, the given one, to n, the one at
  /// the end.
  ///
  /// At the share u of the interval the direction is d = (1 − u) m + u n and a vertex is at x = (1 − u) x0 + u x1. No
  /// point of a shape is higher along d than the support h(d), and h, the greatest of linear functions, is not more
  /// than (1 − u) h(m) + u h(n). So the gap d · x − h(d) is not less than a quadratic function of u with the Bernstein
  /// coefficients m·x0 − h(m), (m·x1 + n·x0 − h(m) − h(n)) / 2 and n·x1 − h(n), which is not less than the least of
  /// them. |d| is not more than the larger of |m| and |n|. A half space has one direction: m = n.
  bool is_apart(const Vec3& m, const Points& here, double begin, double end) const requires(!is_field<Shape>) {
    if (!(end > begin)) return false;
    const Points there = at(end);
    const FoundOnShape nearest = nearest_on(shape_, first(there), margin_);
    if (!(nearest.distance > margin_)) return false;
    const Vec3 n = normal_of(shape_, first(there), nearest.point);
    const double allowed = std::max(allowance(m), allowance(n));
    const double top_m = shape_.support(m), top_n = shape_.support(n);
    for (std::size_t i = 0; i < size_; ++i)
      if (!(dot(m, here[i]) - top_m > allowed) || !(dot(n, there[i]) - top_n > allowed) ||
          // mutant obstacle-bernstein: `!(0.5 ... allowed)` -> `false`
          !(0.5 * ((dot(m, there[i]) - top_m) + (dot(n, here[i]) - top_n)) > allowed))
        return false;
    return true;
  }

  const Shape& shape_;
  Points from_, to_;
  std::size_t size_;
  double margin_, reach_, speed_ = 0;
};

}  // namespace morula::detail
