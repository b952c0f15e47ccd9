// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "geometry/nearest_pair.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <morula/geometry/scale.hpp>

#include "geometry/exact_predicates.hpp"
#include "geometry/triangles/triangles_meet.hpp"

namespace morula::detail {
namespace {

// If the largest |coordinate| is at least this, and differences are no smaller than its rounding, fourth powers of them
// are normal numbers.
constexpr double least_ordinary = 0x1p-200;

Vec3 along(const Vec3& p, const Vec3& q, double s) {
  return s == 0 ? p : s == 1 ? q : p + (q - p) * s;
}

// Whether the segment p q meets the triangle, exactly; a segment in the triangle's plane is left to the distances.
bool pierces(const Vec3& p, const Vec3& q, int side_p, int side_q, const Triangle& t) {
  if (side_p * side_q > 0 || (side_p == 0 && side_q == 0)) return false;
  int least = 0, most = 0;
  for (int k = 0; k < 3; ++k) {
    const int side = orient3d(p, q, t[static_cast<std::size_t>(k)], t[static_cast<std::size_t>((k + 1) % 3)]);
    least = std::min(least, side);
    most = std::max(most, side);
  }
  return least * most == 0;
}

// The parameter at which the line through p and q meets t's plane, up to rounding.
double piercing_parameter(const Vec3& p, const Vec3& q, const Triangle& t) {
  const Vec3 normal = area_vector(t);
  const double height_p = dot(normal, p - t[0]), height_q = dot(normal, q - t[0]);
  const double difference = height_p - height_q;
  return difference == 0 ? 0.0 : std::clamp(height_p / difference, 0.0, 1.0);
}

class Search {
 public:
  Search(std::span<const Vec3> a, const Triangle& b) : a_(a), b_(b) {}

  NearestPair run() {
    if (a_.size() > 1 && find_crossing()) return best_;
    try_features_until(-1);
    bound();
    // Shapes that meet in one plane and nowhere else have no edge that pierces: an exact verdict is needed if no slab
    // is between.
    if (best_.lower <= 0 && meet()) {
      best_.lower = best_.upper = 0;
      best_.crossing = true;
    }
    return best_;
  }

  /// The squared distance of the nearest features, found by run(), which stops when it is so small.
  double try_features_until(double squared) {
    for (std::size_t i = 0; i < a_.size() && squared_ > squared; ++i) {
      const TrianglePoint nearest = closest_point(b_, a_[i]);
      if (improves(nearest.squared_distance)) accept(corner(i), nearest.barycentric, a_[i], nearest.point);
    }
    if (a_.size() == 3) {
      const Triangle t{a_[0], a_[1], a_[2]};
      for (std::size_t j = 0; j < 3 && squared_ > squared; ++j) {
        const TrianglePoint nearest = closest_point(t, b_[j]);
        if (improves(nearest.squared_distance)) accept(nearest.barycentric, corner(j), nearest.point, b_[j]);
      }
    }
    for (std::size_t i = 0; i < edge_count() && squared_ > squared; ++i)
      for (std::size_t j = 0; j < 3; ++j) try_edges(i, (i + 1) % a_.size(), j, (j + 1) % 3);
    return squared_;
  }

 private:
  std::size_t edge_count() const { return a_.size() == 3 ? 3 : a_.size() - 1; }
  static Barycentric corner(std::size_t i) {
    Barycentric b{};
    b[i] = 1;
    return b;
  }
  static Barycentric on_edge(std::size_t i, std::size_t j, double s) {
    Barycentric b{};
    b[i] = 1 - s;
    b[j] = s;
    return b;
  }
  bool improves(double squared) {
    if (!(squared < squared_)) return false;
    squared_ = squared;
    return true;
  }
  void accept(const Barycentric& a, const Barycentric& b, const Vec3& point_a, const Vec3& point_b) {
    best_.a = a;
    best_.b = b;
    best_.point_a = point_a;
    best_.point_b = point_b;
  }

  void try_edges(std::size_t i, std::size_t i2, std::size_t j, std::size_t j2) {
    const auto [s, t] = nearest_on_segments(a_[i], a_[i2] - a_[i], b_[j], b_[j2] - b_[j]);
    const Vec3 p = along(a_[i], a_[i2], s), q = along(b_[j], b_[j2], t);
    if (improves(squared_distance(p, q))) accept(on_edge(i, i2, s), on_edge(j, j2, t), p, q);
  }

  bool find_crossing() {
    int sides[3];
    int least = 1, most = -1;
    for (std::size_t i = 0; i < a_.size(); ++i) {
      sides[i] = orient3d(b_[0], b_[1], b_[2], a_[i]);
      least = std::min(least, sides[i]);
      most = std::max(most, sides[i]);
    }
    if (least > 0 || most < 0) return false;
    for (std::size_t i = 0; i < edge_count(); ++i) {
      const std::size_t i2 = (i + 1) % a_.size();
      if (!pierces(a_[i], a_[i2], sides[i], sides[i2], b_)) continue;
      const double s = piercing_parameter(a_[i], a_[i2], b_);
      const Vec3 p = along(a_[i], a_[i2], s);
      const TrianglePoint nearest = closest_point(b_, p);
      accept(on_edge(i, i2, s), nearest.barycentric, p, nearest.point);
      return best_.crossing = true;
    }
    if (a_.size() < 3) return false;
    const Triangle t{a_[0], a_[1], a_[2]};
    for (std::size_t j = 0; j < 3; ++j) sides[j] = orient3d(t[0], t[1], t[2], b_[j]);
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t j2 = (j + 1) % 3;
      if (!pierces(b_[j], b_[j2], sides[j], sides[j2], t)) continue;
      const double s = piercing_parameter(b_[j], b_[j2], t);
      const Vec3 p = along(b_[j], b_[j2], s);
      const TrianglePoint nearest = closest_point(t, p);
      accept(nearest.barycentric, on_edge(j, j2, s), nearest.point, p);
      return best_.crossing = true;
    }
    return false;
  }

  bool meet() const {
    if (a_.size() == 1) return triangles_meet({a_[0], a_[0], a_[0]}, b_);
    if (a_.size() == 2) return triangles_meet({a_[0], a_[1], a_[1]}, b_);
    return triangles_meet({a_[0], a_[1], a_[2]}, b_);
  }

  // Points on edges and in triangles are off by less than 11 u of the largest coordinate each, corners not at all.
  void bound() {
    double coordinate = 0;
    for (const Vec3& p : a_) coordinate = std::max(coordinate, max_norm(p));
    for (const Vec3& p : b_) coordinate = std::max(coordinate, max_norm(p));
    const auto is_corner = [](const Barycentric& b) { return b[0] == 1 || b[1] == 1 || b[2] == 1; };
    const bool corners = is_corner(best_.a) && is_corner(best_.b);
    const Vec3 direction = best_.point_b - best_.point_a;
    // mutant nearest-upper: `* (1 + 0x1p-49) +` -> `+`
    // mutant nearest-upper-of-edges: `(corners ? 0.0 : 0x1p-48 * coordinate)` -> `0.0`
    best_.upper = scaled_length(direction) * (1 + 0x1p-49) + (corners ? 0.0 : 0x1p-48 * coordinate);
    best_.lower = std::max(0.0, slab_width(a_, b_, best_.point_a, direction));
    if (best_.upper - best_.lower > 0x1p-40 * best_.upper) try_other_slabs();
  }

  // If the shapes are so near that the direction between the points found is mostly rounding, tries the directions of
  // the features themselves.
  void try_other_slabs() {
    try_slab(area_vector(b_));
    if (a_.size() == 3) try_slab(area_vector({a_[0], a_[1], a_[2]}));
    for (std::size_t i = 0; i < a_.size(); ++i)
      for (std::size_t j = 0; j < 3; ++j) {
        const Vec3 d = a_[(i + 1) % a_.size()] - a_[i], e = b_[(j + 1) % 3] - b_[j], w = b_[j] - a_[i];
        try_slab(cross(d, e));
        try_slab(cross(d, cross(w, d)));
        try_slab(cross(e, cross(w, e)));
        try_slab(w);
      }
  }
  void try_slab(const Vec3& direction) {
    for (const Vec3& v : {direction, -direction})
      best_.lower = std::max(best_.lower, slab_width(a_, b_, best_.point_a, v));
  }

  std::span<const Vec3> a_;
  const Triangle& b_;
  NearestPair best_;
  double squared_ = std::numeric_limits<double>::infinity();
};

}  // namespace

NearestPair nearest_pair(std::span<const Vec3> a, const Triangle& b) {
  double largest = 0;
  for (const Vec3& p : a) largest = std::max(largest, max_norm(p));
  for (const Vec3& p : b) largest = std::max(largest, max_norm(p));
  if (largest == 0 || !(largest < least_ordinary)) return Search(a, b).run();
  // Shapes so small that squares underflow are scaled up by a power of two, which changes no digit.
  const int exponent = -std::ilogb(largest);
  const auto times = [](const Vec3& p, int power) {
    return Vec3{std::ldexp(p.x, power), std::ldexp(p.y, power), std::ldexp(p.z, power)};
  };
  std::array<Vec3, 3> large_a;
  for (std::size_t i = 0; i < a.size(); ++i) large_a[i] = times(a[i], exponent);
  const Triangle large_b{times(b[0], exponent), times(b[1], exponent), times(b[2], exponent)};
  NearestPair found = Search(std::span<const Vec3>(large_a).first(a.size()), large_b).run();
  found.point_a = times(found.point_a, -exponent);
  found.point_b = times(found.point_b, -exponent);
  if (found.crossing) return found;
  // Scaling back rounds denormals.
  constexpr double rounding = std::numeric_limits<double>::denorm_min();
  found.upper = found.upper > 0 ? std::ldexp(found.upper, -exponent) + rounding : 0;
  found.lower = std::max(0.0, std::ldexp(found.lower, -exponent) - rounding);
  return found;
}

bool are_within(const Triangle& a, const Triangle& b, double distance) {
  double largest = 0;
  for (const Triangle* t : {&a, &b})
    for (const Vec3& p : *t) largest = std::max(largest, max_norm(p));
  // upper exceeds the distance of the nearest features by 2^-48 of the largest coordinate and 2^-49 of itself at most.
  // mutant within-rounding: `0x1p-40` -> `0`
  const double rounding = 0x1p-40 * (largest + distance), near = distance - rounding, far = distance + rounding;
  if (largest >= least_ordinary && near > 0x1p-400 && far < 0x1p400) {
    // If a slab between them is wider than that, upper is larger: upper is no less than their distance, which is no
    // less than the slab.
    if (slab_width(a, b, a[0], (b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2])) > distance) return false;
    const double squared = Search(a, b).try_features_until(near * near);
    if (squared <= near * near) return true;
    // Crossing shapes are at distance 0, and its features may be far apart.
    // mutant within-crossing: `triangles_meet(a, b)` -> `false`
    if (squared > far * far) return triangles_meet(a, b);
  }
  return nearest_pair(a, b).upper <= distance;
}

SegmentParameters nearest_on_segments(const Vec3& p, const Vec3& d, const Vec3& q, const Vec3& e) {
  const Vec3 r = p - q;
  const double dd = squared_length(d), ee = squared_length(e), er = dot(e, r);
  // A shorter segment counts as its first end: products of its square with that of the other would underflow. It is
  // 2^-150 times as long as the largest coordinate of a usable mesh at most.
  // mutant nearest-underflow: `0x1p-500` -> `0`
  constexpr double negligible = 0x1p-500;
  if (dd <= negligible && ee <= negligible) return {0, 0};
  if (dd <= negligible) return {0, std::clamp(er / ee, 0.0, 1.0)};
  const double dr = dot(d, r);
  if (ee <= negligible) return {std::clamp(-dr / dd, 0.0, 1.0), 0};
  // Cross products are used: between nearly parallel segments, differences of products of dot products lose all digits.
  const double de = dot(d, e);
  const Vec3 normal = cross(d, e);
  const double determinant = squared_length(normal);
  double s = determinant > 0 ? std::clamp(dot(cross(e, r), normal) / determinant, 0.0, 1.0) : 0.0;
  double t = (de * s + er) / ee;
  if (t < 0) {
    t = 0;
    s = std::clamp(-dr / dd, 0.0, 1.0);
  } else if (t > 1) {
    t = 1;
    s = std::clamp((de - dr) / dd, 0.0, 1.0);
  }
  return {s, t};
}

double nearest_parameter(const Vec3& p, const Vec3& q, const Vec3& x) {
  const Vec3 d = q - p;
  const double square = squared_length(d);
  return square > 0 ? std::clamp(dot(x - p, d) / square, 0.0, 1.0) : 0.0;
}

double slab_width(std::span<const Vec3> a, std::span<const Vec3> b, const Vec3& from, const Vec3& any_direction) {
  const double largest = max_norm(any_direction);
  if (!(largest > 0) || !is_finite(any_direction)) return 0;
  // Its length is irrelevant, so it is scaled such that no square of it underflows.
  const int exponent = std::ilogb(largest);
  const Vec3 direction{std::ldexp(any_direction.x, -exponent), std::ldexp(any_direction.y, -exponent),
                       std::ldexp(any_direction.z, -exponent)};
  const double size = length(direction);
  // `from` and `direction` count as exact, for any choice of them. A difference is off by u of its length w, its
  // product with the direction by 5 u |direction| w: both sides together by 10 u w, and 2^-49 w = 16 u w.
  double top = -std::numeric_limits<double>::infinity(), bottom = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const Vec3& p : a) {
    const Vec3 w = p - from;
    top = std::max(top, dot(direction, w));
    farthest = std::max(farthest, squared_length(w));
  }
  for (const Vec3& p : b) {
    const Vec3 w = p - from;
    bottom = std::min(bottom, dot(direction, w));
    farthest = std::max(farthest, squared_length(w));
  }
  const double width = (bottom - top) / size;
  // Squares of differences below 2^-511 underflow; errors of such differences are below 2^-560.
  // mutant nearest-slab-heights: `49 * std::sqrt(farthest) - 0x1p-` -> ``
  return width - 0x1p-50 * std::abs(width) - 0x1p-49 * std::sqrt(farthest) - 0x1p-560;
}

}  // namespace morula::detail
