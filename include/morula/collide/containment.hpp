// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Containment: tests whether points, balls and other bodies are inside a body, deformed and at its transform.
#pragma once

#include <morula/collide/primitives.hpp>
#include <span>
#include <vector>

namespace morula {

/// The place of a point relative to a solid. The solid consists of the points inside a closed surface and on it.
struct [[nodiscard]] PointLocation {
  Status status;
  bool inside = false;      ///< true if the solid contains the point
  bool on_surface = false;  ///< true if the point is exactly on a facet
  /// Winding number of the surface around the point. Inside a body whose facets face outward it is 1, and more where
  /// the body overlaps itself; facets that face inward make it negative. It is 0 outside, on the surface, and for
  /// bodies that are not oriented.
  int winding = 0;
  bool certified = false;  ///< SphereState::covers of the body; if false, facets may be missed, and `inside` be wrong
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< number of tests of the half line with spheres, and with facets
};

/// The place of a ball relative to a solid.
struct [[nodiscard]] Probe {
  Status status;
  bool inside = false;   ///< true if the solid contains the ball's center
  bool touches = false;  ///< true if depth is 0 or more: the ball touches the solid or overlaps it
  double distance = 0;   ///< distance from the center to the surface, mesh units; negative inside
  double depth = 0;  ///< radius − distance, mesh units: the way along `normal` on which the ball leaves the solid there
  SurfacePoint nearest{};  ///< point of the surface nearest to the center
  Vec3 normal{};           ///< unit vector along which the ball leaves the solid at `nearest`
};

/// The components of a body that are inside another body.
struct [[nodiscard]] Containment {
  Status status;
  std::vector<std::uint8_t> inside;  ///< one per given vertex, hence component: 1 inside or on the surface, 0 outside
  std::size_t inside_count = 0;      ///< number of components that are inside
  bool certified = false;            ///< SphereState::covers of the outer body; if false, `inside` may be wrong

  /// True if all components are inside, and there is at least one.
  bool all() const { return inside_count == inside.size() && inside_count > 0; }
  bool any() const { return inside_count > 0; }
};

/// The lowest vertex of each component of the surface, ascending. Facets that share a vertex belong to one component.
/// Components depend on facets alone, so deformation does not change them. Cost: nearly linear in vertices and facets.
std::vector<std::uint32_t> component_vertices(const MeshView& mesh);

/// Finds whether points are inside a body. A point is inside if the winding number of the surface around it is not 0.
/// So overlapping parts count as inside, and a shell inside a shell is a cavity if its facets face into the cavity. A
/// closed surface without an orientation (MeshReport::oriented) has no winding number: a point is then inside if a ray
/// from it crosses the surface an odd number of times.
///
/// The result is exact for the world positions that Collider::vertex returns, if the spheres cover
/// (PointLocation::certified). The query follows a half line from the point along one of the six axis directions, the
/// one that probably meets the fewest facets. It tests each facet of the leaves whose spheres the half line meets,
/// once. If the half line passes through an edge or a vertex, it is shifted by the same infinitely small amount for all
/// facets. Signs are exact [shewchuk1997], so no facet is counted twice or missed.
///
/// Only one thread may use a query at a time. Cost: one test per sphere that the half line meets, with its siblings,
/// and per facet of these leaves; about 15 us on a body of 5,760 facets.
class InsideQuery {
 public:
  /// Shares the collider's state, and reads its present transform and positions in every call. Throws
  /// std::invalid_argument for a collider without facets, and for an open surface, which has no inside: one with an
  /// edge of an odd number of facets (MeshReport::closed). The message has the numbers of edges with one facet and with
  /// more than two. Cost: O(F log F) for F facets, so make the query once per mesh.
  explicit InsideQuery(const Collider& body);

  /// Locates a point, in world coordinates. Rejects a point that is not finite or has a |coordinate| of 2^200 or more,
  /// and a body that queries reject. Allocates only while its lists grow.
  PointLocation locate(const Vec3& point);
  /// Locates a ball relative to the solid: its distance and depth, also for a ball far from the solid. If several
  /// points of the surface are nearest to the center, `nearest` is the one on the facet of the lowest number. Rejects a
  /// ball that TouchQuery rejects.
  Probe probe(const Sphere& ball);

  /// Finds the components of `other` that are inside this body. vertices: one vertex of each component of `other`, such
  /// as component_vertices(); each is located. If the two surfaces do not cross, the result holds for the whole
  /// component; the caller makes sure of that, for example by DistanceBounds::lower above 0. The surface of `other` may
  /// be open. Returns false, with the status in `result`, if a body is rejected, a vertex is out of range, or a
  /// callback moves a body during the call.
  bool components_inside(const Collider& other, std::span<const std::uint32_t> vertices, Containment& result);

  /// True if neighboring facets of the surface agree on the outside, so points have winding numbers.
  bool is_oriented() const { return is_oriented_; }
  const Collider& collider() const { return *body_; }

 private:
  std::shared_ptr<const Collider> body_;
  bool is_oriented_;
  std::vector<std::uint32_t> facets_;
  TouchQuery touch_;
};

}  // namespace morula
