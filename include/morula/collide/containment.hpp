// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Containment: inside or outside a deformed, placed body, exactly; one body inside another; a probe with a side.
#pragma once

#include <morula/collide/primitives.hpp>
#include <span>
#include <vector>

namespace morula {

struct [[nodiscard]] PointLocation {
  Status status;
  bool inside = false;      ///< the solid contains the point; its surface belongs to it
  bool on_surface = false;  ///< exactly on a facet
  /// How often the surface winds around the point: 1 inside a body whose facets look outwards, more where it overlaps
  /// itself, negative where it is turned inside out. 0 on the surface, and in bodies that are not oriented.
  int winding = 0;
  bool certified = false;  ///< SphereState::covers of the body; else facets may have been missed
  std::size_t sphere_tests = 0, facet_tests = 0;
};

/// A ball that knows its side of the surface.
struct [[nodiscard]] Probe {
  Status status;
  bool inside = false;     ///< the center is inside
  bool touches = false;    ///< depth is 0 or more
  double distance = 0;     ///< from the center to the surface, negative inside
  double depth = 0;        ///< radius - distance: how far the ball reaches into the solid, at the nearest wall
  SurfacePoint nearest{};  ///< of the surface, to the center
  Vec3 normal{};           ///< unit: where the ball has to go to come out
};

/// How many components of a body are in another.
struct [[nodiscard]] Containment {
  Status status;
  std::vector<std::uint8_t> inside;  ///< per component: 1 inside (or on the surface), 0 outside
  std::size_t inside_count = 0;
  bool certified = false;

  bool all() const { return inside_count == inside.size() && inside_count > 0; }
  bool any() const { return inside_count > 0; }
};

/// Pieces of surface that are connected by shared vertices: the lowest vertex of each that a facet uses, ascending.
/// They hang on the facets alone, so deformation does not change them. Cost: linear in vertices and facets, nearly.
std::vector<std::uint32_t> component_vertices(const MeshView& mesh);

/// Inside is where the surface winds around a point: any number of times but 0. So overlapping parts count as inside,
/// and a shell within a shell is a cavity when it is turned inwards. A closed surface that is not oriented has no
/// winding: there inside is where a ray from the point crosses it an odd number of times.
///
/// The verdict is exact for the vertices as Collider::vertex gives them. A half line along an axis, the one of six
/// that seems to meet the fewest facets, is followed past the leaf spheres it meets; facets in these are looked at once
/// each. Where it goes
/// through edges and corners, it stands for a line next to it, the same one for all facets. Signs are exact
/// [shewchuk1997], so nothing is counted twice or missed, and no direction is unlucky.
/// Cost: that of the spheres the half line meets and of the facets in their leaves; 15 us on a body of 5,760 facets.
class InsideQuery {
 public:
  /// Borrows the collider; follows its transform and positions. Made once per mesh: O(F log F).
  /// Throws std::invalid_argument for an open surface, which has no inside, saying how many edges are bare.
  explicit InsideQuery(const Collider& body);

  /// No allocation once warm. A point that is not finite is refused.
  PointLocation locate(const Vec3& point);
  /// Where the ball is against the solid, at any distance. Of several nearest points, the lowest facet's.
  Probe probe(const Sphere& ball);

  /// Which components of `other` are inside this body: one test each, of the given vertices (component_vertices). When
  /// the two surfaces do not cross, the verdict is about all of the component: whether they cross is for the caller to
  /// know (DistanceBounds::lower above 0, say). `other` may be open.
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
