// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The signed distance from a height field in long double, over all of its triangles and walls one by one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <morula/robot/world.hpp>
#include <vector>

namespace morula::test {

class TerrainDistance {
 public:
  using Real = long double;
  using Point = std::array<Real, 3>;

  explicit TerrainDistance(const robot::HeightField& field) : pose_(field.pose) {
    columns_ = field.columns, rows_ = field.rows, spacing_ = field.spacing;
    for (std::size_t k = 0; k < rows_; ++k) {
      for (std::size_t i = 0; i < columns_; ++i)
        corners_.push_back({static_cast<Real>(i) * spacing_, static_cast<Real>(k) * spacing_,
                            static_cast<Real>(field.heights[k * columns_ + i])});
    }
  }

  /// p in the axes of the world.
  Real operator()(const Point& p) const {
    Point d{}, q{};
    for (std::size_t k = 0; k < 3; ++k) d[k] = p[k] - static_cast<Real>(pose_.translation[static_cast<int>(k)]);
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t i = 0; i < 3; ++i) q[k] += d[i] * static_cast<Real>(pose_.rows[i][static_cast<int>(k)]);
    return local(q);
  }

 private:
  static Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Real inner(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static Point cross(const Point& a, const Point& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Real length(const Point& a) { return std::sqrt(inner(a, a)); }
  static Real to_segment(const Point& p, const Point& a, const Point& b) {
    const Point ab = minus(b, a), ap = minus(p, a);
    const Real square = inner(ab, ab), t = square > 0 ? std::clamp(inner(ap, ab) / square, Real{0}, Real{1}) : Real{0};
    return length({ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]});
  }
  static Real to_triangle(const Point& p, const std::array<Point, 3>& t) {
    const Point n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
    const Real size = length(n);
    bool is_over = size > 0;
    Real least = INFINITY;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point &a = t[k], &b = t[(k + 1) % 3];
      least = std::min(least, to_segment(p, a, b));
      is_over = is_over && inner(cross(n, minus(b, a)), minus(p, a)) >= 0;
    }
    return is_over ? std::abs(inner(n, minus(p, t[0]))) / size : least;
  }

  const Point& corner(std::size_t i, std::size_t k) const { return corners_[k * columns_ + i]; }

  // Above, seen along z: the sign of the area of (a, b, p).
  static Real side(const Point& a, const Point& b, const Point& p) {
    return (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
  }
  /// True if p lies under the triangle, or on it.
  static bool is_under(const Point& p, const std::array<Point, 3>& t) {
    const std::array<Real, 3> w{side(t[1], t[2], p), side(t[2], t[0], p), side(t[0], t[1], p)};
    if (std::min({w[0], w[1], w[2]}) < 0) return false;
    return p[2] * (w[0] + w[1] + w[2]) <= w[0] * t[0][2] + w[1] * t[1][2] + w[2] * t[2][2];
  }

  Real local(const Point& p) const {
    Real least = INFINITY;
    bool inside = false;
    const auto triangle = [&](const Point& a, const Point& b, const Point& c) {
      least = std::min(least, to_triangle(p, {a, b, c}));
      inside = inside || is_under(p, {a, b, c});
    };
    for (std::size_t k = 0; k + 1 < rows_; ++k) {
      for (std::size_t i = 0; i + 1 < columns_; ++i) {
        triangle(corner(i, k), corner(i + 1, k), corner(i + 1, k + 1));
        triangle(corner(i, k), corner(i + 1, k + 1), corner(i, k + 1));
      }
    }
    // The walls go down to below everything that matters to p.
    const auto wall = [&](const Point& a, const Point& b) {
      const Real low = std::min({p[2], a[2], b[2]}) - 10 * (spacing_ + std::abs(p[2] - a[2]));
      const Point c{b[0], b[1], low}, d{a[0], a[1], low};
      least = std::min({least, to_triangle(p, {a, b, c}), to_triangle(p, {a, c, d})});
    };
    for (std::size_t i = 0; i + 1 < columns_; ++i) {
      wall(corner(i, 0), corner(i + 1, 0));
      wall(corner(i, rows_ - 1), corner(i + 1, rows_ - 1));
    }
    for (std::size_t k = 0; k + 1 < rows_; ++k) {
      wall(corner(0, k), corner(0, k + 1));
      wall(corner(columns_ - 1, k), corner(columns_ - 1, k + 1));
    }
    return inside ? -least : least;
  }

  RigidTransform pose_;
  std::size_t columns_ = 0, rows_ = 0;
  Real spacing_ = 1;
  std::vector<Point> corners_;
};

}  // namespace morula::test
