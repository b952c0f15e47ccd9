// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A distance field as a shape: what placed_shapes.hpp has of others, by its values and by how fast these change.
#pragma once

#include <morula/surface/obstacles.hpp>

#include "collide/shapes/placed_shapes.hpp"

namespace morula::detail {

inline bool is_usable(const DistanceField& field) {
  return field.value && field.lipschitz > 0 && std::isfinite(field.lipschitz) && field.tolerance >= 0 &&
         std::isfinite(field.tolerance);
}

class PlacedField {
 public:
  explicit PlacedField(const DistanceField& field) : field_(&field) {}

  double lipschitz() const { return field_->lipschitz; }
  double distance_at(const Vec3& x) const { return field_->value(x); }
  /// Of points within a distance of x, whose coordinates are off by some 2^-50 of themselves.
  double bound(const Sphere& s) const {
    return field_->value(s.center) - field_->lipschitz * (s.radius * (1 + 0x1p-48) + 0x1p-48 * max_norm(s.center));
  }
  double bound(const Vec3& center, const Vec3& half) const { return bound(Sphere{center, scaled_length(half)}); }

  /// The least value on a facet within the tolerance, or within half of what it is above `margin`: by quarters, whose
  /// centers are asked. A quarter is done when it cannot be so much below the least value known. What is done is no
  /// less than the least value that remains, less that allowance, since the allowance falls more slowly than the value.
  FoundOnShape look_at(const Triangle& t, double margin) const {
    const double edge = std::max({length(t[1] - t[0]), length(t[2] - t[1]), length(t[0] - t[2])});
    const double tolerance = field_->tolerance > 0 ? field_->tolerance : 0.125 * edge * field_->lipschitz;
    FoundOnShape found;
    bool is_number = true;
    const auto ask = [&](const Barycentric& b) {
      const Vec3 x = at_barycentric(t, b);
      const double value = field_->value(x);
      is_number = is_number && !std::isnan(value);
      if (!(value >= found.distance)) found.distance = value, found.barycentric = b, found.point = x;
      return value;
    };
    constexpr std::size_t most_halvings = 16;
    struct Piece {
      std::array<Barycentric, 3> corners;
      std::size_t halvings;
    };
    std::array<Piece, 3 * most_halvings + 4> stack;
    std::size_t count = 0;
    stack[count++] = {{Barycentric{1, 0, 0}, Barycentric{0, 1, 0}, Barycentric{0, 0, 1}}, 0};
    for (const Barycentric& corner : stack[0].corners) ask(corner);
    while (count > 0) {
      const Piece piece = stack[--count];
      const auto& [a, b, c] = piece.corners;
      const auto between = [](const Barycentric& p, const Barycentric& q) {
        return Barycentric{(p[0] + q[0]) * 0.5, (p[1] + q[1]) * 0.5, (p[2] + q[2]) * 0.5};
      };
      const Barycentric middle{(a[0] + b[0] + c[0]) / 3, (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3};
      const double value = ask(middle);
      const Vec3 x = at_barycentric(t, middle);
      double radius = 0;
      for (const Barycentric& corner : piece.corners) radius = std::max(radius, length(at_barycentric(t, corner) - x));
      const double lower = value - field_->lipschitz * (radius * (1 + 0x1p-48) + 0x1p-47 * max_norm(x));
      const double allowed = std::max(tolerance, 0.5 * (found.distance - margin));
      if (!is_number) break;
      if (lower >= found.distance - allowed || field_->lipschitz * radius <= tolerance ||
          piece.halvings == most_halvings) {
        found.lower = std::min(found.lower, lower);
        continue;
      }
      const Barycentric ab = between(a, b), bc = between(b, c), ca = between(c, a);
      stack[count++] = {{a, ab, ca}, piece.halvings + 1};
      stack[count++] = {{ab, b, bc}, piece.halvings + 1};
      stack[count++] = {{ca, bc, c}, piece.halvings + 1};
      stack[count++] = {{ab, bc, ca}, piece.halvings + 1};
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

}  // namespace morula::detail
