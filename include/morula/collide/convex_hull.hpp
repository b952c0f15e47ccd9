// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Convex hull: a solid shape to ask bodies about, like a half space or a capsule.
#pragma once

#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/rigid_transform.hpp>
#include <span>
#include <vector>

namespace morula {

/// All that lies between some points. Plain data, made once; copies are independent.
class ConvexHull {
 public:
  /// normal . x <= offset for every point of the hull, up to rounding; the normal is of unit length.
  struct Plane {
    Vec3 normal{};
    double offset = 0;
  };

  /// Facets are found by exact signs [shewchuk1997], so points on one plane, on one line or given twice do no harm.
  /// Throws std::invalid_argument for a point that is not finite or is 2^100 or more from the origin, and for points
  /// that all lie in one plane. Cost: points × facets.
  explicit ConvexHull(std::span<const Vec3> points);
  /// A box, placed. Throws std::invalid_argument for one that is empty or flat, as above for one that is not finite.
  static ConvexHull box(const Box& box, const RigidTransform& transform = {});
  /// The same hull elsewhere: a rigid motion needs no new facets. Throws std::invalid_argument for a transform that
  /// queries would not take (largest_float_deviation), and as above for points too far away. Cost: points + facets.
  ConvexHull placed(const RigidTransform& transform) const;

  /// Those of the points that facets have, in the order in which they were given.
  std::span<const Vec3> vertices() const { return vertices_; }
  /// Triangles with three different corners, counter-clockwise seen from outside. A flat side has several.
  std::span<const Facet> facets() const { return facets_; }
  /// One per facet.
  std::span<const Plane> planes() const { return planes_; }
  /// No vertex has a larger |coordinate|.
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
