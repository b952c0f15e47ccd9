// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Convex hull: a solid shape for queries against bodies, like a half space or a capsule.
#pragma once

#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <span>
#include <vector>

namespace morula {

/// The convex hull of points. Plain data, made once; copies are independent.
class ConvexHull {
 public:
  /// normal . x <= offset for every point of the hull, up to rounding; the normal is of unit length.
  struct Plane {
    Vec3 normal{};
    double offset = 0;
  };

  /// Facets are found by exact signs [shewchuk1997], so coplanar, collinear and repeated points are handled correctly.
  /// Throws std::invalid_argument for a point that is not finite or is 2^100 or more from the origin, and if all points
  /// lie in one plane. Cost: points × facets.
  explicit ConvexHull(std::span<const Vec3> points);
  /// A box with a transform. Throws std::invalid_argument for an empty, flat or infinite box.
  static ConvexHull box(const Box& box, const RigidTransform& transform = {});
  /// The same hull with a transform; a rigid motion needs no new facets. Throws std::invalid_argument for a transform
  /// that queries do not accept (largest_float_deviation), and for points too far away, like the constructor. Cost:
  /// points + facets.
  ConvexHull placed(const RigidTransform& transform) const;

  /// The points that facets use, in the given order.
  std::span<const Vec3> vertices() const { return vertices_; }
  /// Triangles with three different corners, counter-clockwise seen from outside. A flat side has several triangles.
  std::span<const Facet> facets() const { return facets_; }
  /// One plane per facet.
  std::span<const Plane> planes() const { return planes_; }
  /// The largest |coordinate| of the vertices.
  double largest_coordinate() const { return largest_; }

 private:
  ConvexHull() = default;
  void measure();

  std::vector<Vec3> vertices_;
  std::vector<Facet> facets_;
  std::vector<Plane> planes_;
  double largest_ = 0;
};

}  // namespace morula
