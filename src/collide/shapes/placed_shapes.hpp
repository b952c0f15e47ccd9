// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Shapes prepared for tests of facets: signed distances to a half space, a sphere, a capsule and a convex hull, with
// bounds.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <morula/collide/primitives.hpp>
#include <morula/geometry/scale.hpp>
#include <span>

#include "geometry/nearest_pair.hpp"

namespace morula::detail {

/// The same half space with a normal whose largest |component| is in [1, 2): squares of its lengths stay in range. It
/// is scaled by a power of two, which changes no digit. The normal must be finite and not 0.
HalfSpace scaled(const HalfSpace& shape);

bool is_usable(const HalfSpace& shape);
bool is_usable(const Sphere& shape);
bool is_usable(const Capsule& shape);
bool is_usable(const ConvexHull& shape);
bool is_usable(const Ray& ray);

inline Vec3 abs(const Vec3& v) {
  return {std::abs(v.x), std::abs(v.y), std::abs(v.z)};
}
/// The extent of a box with such half sides from its center along a direction.
inline double width(const Vec3& direction, const Vec3& half) {
  return dot(abs(direction), half);
}

// The relation of a facet to a shape: its deepest point, and a lower bound of all its points' signed distances.
struct FoundOnShape {
  Barycentric barycentric{};
  Vec3 point{};
  double distance = std::numeric_limits<double>::infinity();
  double lower = std::numeric_limits<double>::infinity();
};

// A shape has: bound(sphere) and bound(center, half) of a box, below the signed distances of its points;
// look_at(triangle); normal_at(point, triangle). For steps (surface/obstacles.hpp) also distance_at(point), rounded;
// support(direction), above the heights of its points along any direction in which it is bounded; and size(), the
// largest of its parameters.
class PlacedHalfSpace {
 public:
  static constexpr bool looks_at_spheres_first = false;
  explicit PlacedHalfSpace(const HalfSpace& shape) {
    const HalfSpace unit = scaled(shape);
    const double size = length(unit.normal);
    normal_ = unit.normal / size, offset_ = unit.offset / size;
  }

  // Unit normal and offset are off by 5 u of themselves, products and sums by 4 u of |x| <= 1.8 coordinates: the
  // allowance is 32 u of each.
  double bound(const Sphere& s) const { return distance(s.center) - s.radius * (1 + 0x1p-50) - pad(s.center); }
  double bound(const Vec3& center, const Vec3& half) const {
    return distance(center) - width(normal_, half) * (1 + 0x1p-50) - pad(center);
  }
  FoundOnShape look_at(const Triangle& t) const {
    FoundOnShape found;
    for (std::size_t k = 0; k < 3; ++k) {
      const double d = distance(t[k]);
      found.lower = std::min(found.lower, d - pad(t[k]));
      if (!(d < found.distance)) continue;
      found.distance = d;
      found.barycentric = {};
      found.barycentric[k] = 1;
      found.point = t[k];
    }
    return found;
  }
  Vec3 normal_at(const Vec3&, const Triangle&) const { return normal_; }
  double distance_at(const Vec3& x) const { return distance(x); }
  /// For the normal only.
  double support(const Vec3&) const { return offset_; }
  double size() const { return std::abs(offset_); }

 private:
  double distance(const Vec3& x) const { return dot(normal_, x) - offset_; }
  double pad(const Vec3& x) const { return 0x1p-48 * (max_norm(x) + std::abs(offset_)); }

  Vec3 normal_;
  double offset_;
};

// A capsule, or with one end a sphere.
class PlacedCapsule {
 public:
  static constexpr bool looks_at_spheres_first = true;
  PlacedCapsule(const Vec3& p, const Vec3& q, double radius) : ends_{p, q}, count_(p == q ? 1 : 2), radius_(radius) {}

  // The foot on the axis is off by a few u of the largest coordinate, which can only lengthen the distance by as much.
  double bound(const Sphere& s) const {
    const double coordinate = max_norm(s.center) + std::max(max_norm(ends_[0]), max_norm(ends_[1]));
    return distance(axis_point(s.center), s.center) * (1 - 0x1p-49) - 0x1p-47 * coordinate -
           (s.radius + radius_) * (1 + 0x1p-51);
  }
  double bound(const Vec3& center, const Vec3& half) const {
    // The gap of the boxes about both, along each axis.
    const Vec3 middle = (ends_[0] + ends_[count_ - 1]) * 0.5, reach = abs(ends_[0] - ends_[count_ - 1]) * 0.5;
    const double coordinate = max_norm(center) + size();
    const Vec3 gap = max(abs(center - middle) - half - reach, Vec3{});
    return std::max(scaled_length(gap) * (1 - 0x1p-49) - radius_ * (1 + 0x1p-51) - 0x1p-47 * coordinate,
                    bound(Sphere{center, scaled_length(half) * (1 + 0x1p-49)}));
  }
  FoundOnShape look_at(const Triangle& t) const {
    const NearestPair pair = nearest_pair(std::span(ends_).first(count_), t);
    FoundOnShape found;
    found.barycentric = pair.b;
    found.point = pair.point_b;
    // The distance is measured again, because the pair's upper bound is padded.
    found.distance = (pair.crossing ? 0.0 : scaled_length(pair.point_b - pair.point_a)) - radius_;
    found.lower = pair.lower - radius_ - 0x1p-52 * (pair.lower + radius_);
    return found;
  }
  // On the axis there is no such direction, and next to it rounding determines it: there the normal pushes the surface
  // back through its own inside.
  Vec3 normal_at(const Vec3& x, const Triangle& t) const {
    const Vec3 out = x - axis_point(x), inward = normalized(-area_vector(t));
    return max_norm(out) > 0x1p-40 * max_norm(x) ? normalized(out, inward) : inward;
  }
  double distance_at(const Vec3& x) const { return scaled_length(x - axis_point(x)) - radius_; }
  double support(const Vec3& direction) const {
    return std::max(dot(direction, ends_[0]), dot(direction, ends_[count_ - 1])) + radius_ * length(direction);
  }
  double size() const { return std::max({max_norm(ends_[0]), max_norm(ends_[1]), radius_}); }

 private:
  Vec3 axis_point(const Vec3& x) const {
    return count_ == 1 ? ends_[0] : ends_[0] + (ends_[1] - ends_[0]) * nearest_parameter(ends_[0], ends_[1], x);
  }

  std::array<Vec3, 2> ends_;
  std::size_t count_;
  double radius_;
};

// The signed distance to a convex set is the largest height above any of its supporting planes, so the planes that a
// hull has bound it from below, whatever the rounding of their normals; inside it is the largest of these, outside the
// distance to a facet.
class PlacedHull {
 public:
  static constexpr bool looks_at_spheres_first = true;
  explicit PlacedHull(const ConvexHull& hull) : hull_(&hull) {}

  // Normals are off by 5 u of themselves, products and sums by 4 u of |x| <= 1.8 coordinates, here and for the offset:
  // the allowance is 32 u of each.
  double bound(const Sphere& s) const { return height(s.center) - s.radius * (1 + 0x1p-50) - pad(max_norm(s.center)); }
  double bound(const Vec3& center, const Vec3& half) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const ConvexHull::Plane& plane : hull_->planes())
      most = std::max(most, dot(plane.normal, center) - plane.offset - width(plane.normal, half) * (1 + 0x1p-50));
    return most - pad(max_norm(center));
  }
  FoundOnShape look_at(const Triangle& t) const;
  Vec3 normal_at(const Vec3& x, const Triangle&) const;
  double distance_at(const Vec3& x) const;
  double support(const Vec3& direction) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Vec3& p : hull_->vertices()) most = std::max(most, dot(direction, p));
    return most;
  }
  double size() const { return hull_->largest_coordinate(); }

 private:
  double height(const Vec3& x) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const ConvexHull::Plane& plane : hull_->planes()) most = std::max(most, dot(plane.normal, x) - plane.offset);
    return most;
  }
  std::size_t highest_plane(const Vec3& x) const;
  double pad(double coordinate) const { return 0x1p-48 * (coordinate + hull_->largest_coordinate()); }
  Triangle facet(std::size_t f) const {
    const Facet& corners = hull_->facets()[f];
    return {hull_->vertices()[corners[0]], hull_->vertices()[corners[1]], hull_->vertices()[corners[2]]};
  }
  /// The point of a triangle that is lowest below the planes, and its height.
  FoundOnShape lowest(const Triangle& t) const;

  const ConvexHull* hull_;
};

}  // namespace morula::detail
