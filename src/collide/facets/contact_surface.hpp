// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// From a contact of spheres to one of surfaces: its nearest facets, their mean normal, and a depth less the protrusion
// of the spheres.
#pragma once

#include <cassert>
#include <morula/collide/contacts.hpp>

#include "collide/facets/leaf_surfaces.hpp"

namespace morula::detail {

/// The shared data of queries about the same two bodies: their leaves, each read once. One thread at a time may use it.
class SurfaceScratch {
 public:
  /// Begins a batch: transforms, positions and spheres stay as they are until the next. Both colliders must be current.
  /// Both may be the same collider. Allocates when more leaves are read than in any earlier batch.
  void start(const Collider& a, const Collider& b);
  /// The leaves of one of the two.
  LeafSurfaces& of(const Collider& collider) {
    assert(&collider == sides_[0].collider() || &collider == sides_[1].collider());
    return sides_[&collider == sides_[0].collider() ? 0 : 1];
  }

  std::vector<float> gaps;  ///< memory

 private:
  LeafSurfaces sides_[2];
};

/// The point nearest to `point`, in the world, on the facets of which the node owns a part. closest_point() computes
/// distances in the body's own coordinates, from positions without any rounding by a transform; ties go to the lowest
/// facet. The result has the same bits as brute force. Cost: 0.2 to 0.4 µs for leaves of 12 facets, twice that for 150,
/// and 16 ns per facet of a leaf that is read.
SurfacePoint nearest_facet(const Collider& collider, std::uint32_t node, const Vec3& point, SurfaceScratch& scratch);

/// Mean normal of a node's region, in the world, weighted by area, at the current positions: the less its facets agree,
/// the shorter it is; zero for a whole closed surface.
Vec3 mean_normal(const Collider& collider, std::uint32_t node, SurfaceScratch& scratch);

/// An upper bound of the node's region along a unit vector of the world: its sphere's reach or, where this is less,
/// that of the farthest corner of its facets. It is rounded up by about 1e-6 of the leaf.
double region_reach(const Collider& collider, std::uint32_t node, const Vec3& direction, SurfaceScratch& scratch);

/// point, sphere_normal (unit, from b to a) and depth belong to the contact of two nodes' spheres.
///
/// The normal lies between the spheres' normal and the difference of the mean normals of both regions. It is the former
/// where both spheres bulge with their regions, and the latter where one stands off its region by its radius, as it
/// does where its center lies in the surface. It is also the former where the regions do not face each other. The depth
/// is at most (depth - E_a - E_b)⁺, E the excess of a sphere: its protrusion beyond the farthest corner of its facets,
/// along the contact. docs/explanation/fronts.md has errors.
ContactSurface contact_surface(const Collider& a, std::uint32_t node_a, const Collider& b, std::uint32_t node_b,
                               const Vec3& point, const Vec3& sphere_normal, double depth, SurfaceScratch& scratch);

}  // namespace morula::detail
