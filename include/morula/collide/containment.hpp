// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Containment: exact inside tests for a deformed, placed body; one body inside another; a ball with its side of the
// surface.
#pragma once

#include <morula/collide/primitives.hpp>
#include <span>
#include <vector>

namespace morula {

struct [[nodiscard]] PointLocation {
  Status status;
  bool inside = false;      ///< true if the solid contains the point; the surface belongs to the solid
  bool on_surface = false;  ///< true if the point is exactly on a facet
  /// Winding number of the surface around the point: 1 inside a body whose facets face outward, more if the body
  /// overlaps itself, negative if it is inside out. 0 on the surface, and in bodies that are not oriented.
  int winding = 0;
  bool certified = false;  ///< SphereState::covers of the body; if false, facets may be missed
  std::size_t sphere_tests = 0, facet_tests = 0;
};

/// The place of a ball relative to a solid.
struct [[nodiscard]] Probe {
  Status status;
  bool inside = false;   ///< true if the center is inside
  bool touches = false;  ///< true if depth is 0 or more
  double distance = 0;   ///< distance from the center to the surface, mesh units; negative inside
  double depth = 0;  ///< radius - distance, mesh units: how deep the ball reaches into the solid at the nearest wall
  SurfacePoint nearest{};  ///< point of the surface nearest to the center
  Vec3 normal{};           ///< unit vector in which the ball leaves the solid
};

/// The components of a body that are inside another body.
struct [[nodiscard]] Containment {
  Status status;
  std::vector<std::uint8_t> inside;  ///< one per component: 1 inside (or on the surface), 0 outside
  std::size_t inside_count = 0;
  bool certified = false;

  bool all() const { return inside_count == inside.size() && inside_count > 0; }
  bool any() const { return inside_count > 0; }
};

/// Components of the surface, connected by shared vertices: for each the lowest vertex that a facet uses, ascending.
/// They depend on the facets alone, so deformation does not change them. Cost: nearly linear in vertices and facets.
std::vector<std::uint32_t> component_vertices(const MeshView& mesh);

/// A point is inside if the winding number of the surface around it is not 0. So overlapping parts count as inside, and
/// a shell inside a shell is a cavity if it is oriented inward. A closed surface that is not oriented has no winding
/// number: a point is then inside if a ray from it crosses the surface an odd number of times.
///
/// The verdict is exact for the vertices of Collider::vertex. The query follows a half line along one of the six axis
/// directions, the one that probably meets the fewest facets, and reads the facets in the leaf spheres that it meets,
/// each once. If the half line passes through an edge or a corner, it stands for a line next to it, the same one for
/// all facets. Signs are exact [shewchuk1997], so no facet is counted twice or missed, in any direction. Cost: one test
/// per sphere that the half line meets and per facet in these leaves; 15 us on a body of 5,760 facets.
class InsideQuery {
 public:
  /// Borrows the collider and follows its transform and positions. Made once per mesh: O(F log F). Throws
  /// std::invalid_argument for an open surface, which has no inside; the message gives the number of border edges.
  explicit InsideQuery(const Collider& body);

  /// Locates a point. Allocates nothing once its lists have grown. Rejects a point that is not finite.
  PointLocation locate(const Vec3& point);
  /// Locates a ball relative to the solid, at any distance. If several points are nearest, the one on the lowest facet
  /// is returned.
  Probe probe(const Sphere& ball);

  /// Finds the components of `other` inside this body, with one test per given vertex (component_vertices). If the two
  /// surfaces do not cross, the verdict holds for the whole component; the caller has to make sure that they do not
  /// cross (for example by DistanceBounds::lower above 0). `other` may be open.
  bool components_inside(const Collider& other, std::span<const std::uint32_t> vertices, Containment& result);

  bool is_oriented() const { return is_oriented_; }
  const Collider& collider() const { return *body_; }

 private:
  const Collider* body_;
  bool is_oriented_;
  std::vector<std::uint32_t> facets_;
  TouchQuery touch_;
};

}  // namespace morula
