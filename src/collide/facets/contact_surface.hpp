// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// From a contact of spheres to one of surfaces: the facets that answer for it, their mean normal, and a depth without
// what the spheres stick out of the surface.
#pragma once

#include <cassert>
#include <morula/collide/contacts.hpp>

#include "collide/facets/leaf_surfaces.hpp"

namespace morula::detail {

/// What questions about the same two bodies share: their leaves, read once. For one thread at a time.
class SurfaceScratch {
 public:
  /// Begins a batch: transforms, positions and spheres stay as they are until the next. Both colliders current. The
  /// same collider may be both. Allocates when the bodies are others than before, or more is read than ever before.
  void start(const Collider& a, const Collider& b);
  /// The same with shares that others keep, until the next batch: several scratches may take them from one place.
  void start(const Collider& a, const FacetShares& shares_a, const Collider& b, const FacetShares& shares_b);
  /// Of one of the two.
  LeafSurfaces& of(const Collider& collider) {
    assert(&collider == sides_[0].collider() || &collider == sides_[1].collider());
    return sides_[&collider == sides_[0].collider() ? 0 : 1];
  }

  std::vector<float> gaps;  ///< memory

 private:
  LeafSurfaces sides_[2];
};

/// The point nearest to `point`, in the world, of the facets of which the node owns a part. Distances are taken by
/// closest_point() in the body's own coordinates, to positions that no rounding of a transform has touched; ties go to
/// the lowest facet. The same bits as brute force. Cost: 0.2 to 0.4 µs for leaves of 12 facets, twice that for 150, and
/// 16 ns per facet of a leaf that is read.
SurfacePoint nearest_facet(const Collider& collider, std::uint32_t node, const Vec3& point, SurfaceScratch& scratch);

/// Mean normal of what a node owns, in the world, by area, at the current positions: the shorter the less its facets
/// agree; zero for a whole closed surface.
Vec3 mean_normal(const Collider& collider, std::uint32_t node, SurfaceScratch& scratch);

/// How far the node's region reaches along a unit vector of the world, at most: its sphere's reach or, where this is
/// less, that of the farthest corner of its facets. Rounded up by some 1e-6 of the leaf.
double region_reach(const Collider& collider, std::uint32_t node, const Vec3& direction, SurfaceScratch& scratch);

/// point, sphere_normal (unit, from b to a) and depth: of the contact of two nodes' spheres.
///
/// The normal lies between the spheres' and the difference of the mean normals of both regions: at the former where
/// both spheres bulge with their regions, at the latter where one stands off its region by its radius, as it does where
/// its center lies in the surface; at the former, too, where the regions do not face each other. The depth is at most
/// (depth - E_a - E_b)⁺, E the excess of a sphere: how far it sticks out beyond the farthest corner of its facets,
/// along the contact. docs/explanation/contact_surfaces.md has errors.
ContactSurface contact_surface(const Collider& a, std::uint32_t node_a, const Collider& b, std::uint32_t node_b,
                               const Vec3& point, const Vec3& sphere_normal, double depth, SurfaceScratch& scratch);

}  // namespace morula::detail
