// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Simple shapes against a body: a floor, a tool, a haptic probe, a picking ray.
//
// All of these queries are about the body's surface, not its interior: a sphere inside a closed body that does not
// reach a wall touches nothing. InsideQuery tests the interior (containment.hpp). Surfaces may be open. Shapes are in
// world coordinates; the transform of its collider places a body.
//
//   const morula::Touch floor = morula::touch(a, morula::HalfSpace{.normal = {0, 0, 1}, .offset = 0});
//   if (floor.touches) std::printf("%g below the floor\n", floor.deepest->depth);
//   morula::TouchQuery tool;  // keeps its memory from frame to frame
//   if (tool.run(a, morula::Capsule{{0, 0, 1}, {0, 0, 2}, 0.1}).proven_clear) std::puts("the tool is clear of the body");
//   const morula::RayHit hit = morula::first_hit(a, {.origin = {0, 0, 5}, .direction = {0, 0, -1}});
//   if (hit.first) std::printf("the ray hits facet %u\n", hit.first->point.facet);
#pragma once

#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/convex_hull.hpp>
#include <morula/geometry/triangle.hpp>
#include <optional>
#include <vector>

namespace morula {

/// The half space normal . x <= offset: all points behind a plane. The normal may have any length except 0; the plane
/// is nearer than 2^200 to the origin.
struct HalfSpace {
  Vec3 normal{0, 0, 1};
  double offset = 0;
};
/// The points within radius (0 or more) of the segment from p to q; p = q gives a ball.
struct Capsule {
  Vec3 p{}, q{};
  double radius = 0;
};

struct TouchOptions {
  /// Largest distance outside the shape that still counts as a touch; a negative margin is the least depth inside. Mesh
  /// units.
  double margin = 0;
  bool nearest = false;        ///< find the nearest point of the surface even if it is farther away than the margin
  bool stop_at_first = false;  ///< stop at the first touching facet, for a yes or no
  bool collect_all = false;    ///< list every facet that touches, and the leaves that own parts of them
};

/// The point of a facet that is deepest in the shape.
struct TouchingFacet {
  SurfacePoint point{};
  /// Depth of the point inside the shape, mesh units; negative outside. A capsule limits it to its radius, because the
  /// depth decreases behind its axis.
  double depth = 0;
  Vec3 normal{};  ///< unit vector out of the shape at the point; into the body on a capsule's axis or at a sphere's
                  ///< center
};

struct [[nodiscard]] Touch {
  Status status;
  bool touches = false;  ///< the depth of the result, in double, is -margin or more
  /// Proof that no point of the surface is within the margin. If the surface only just touches, up to rounding, both
  /// may be false.
  bool proven_clear = false;
  bool certified = false;  ///< SphereState::covers of the body; if false, `proven_clear` and `lower` are not proven
  /// Lower bound of the surface's signed distance to the shape (negative inside), mesh units. It is near the depth of
  /// the result, or above the margin if `proven_clear`; looser with `stop_at_first`.
  double lower = 0;
  /// The deepest point within the margin, or at any distance with `nearest`: on the lowest facet of equals, or on the
  /// first touching facet with `stop_at_first`; no value if there is none.
  std::optional<TouchingFacet> deepest;
  /// With `collect_all`: all touching facets, ascending, each with its own deepest point.
  std::vector<TouchingFacet> facets;
  /// With `collect_all`: the leaves that own a part of these facets and whose spheres reach the shape.
  std::vector<std::uint32_t> leaves;
  std::size_t sphere_tests = 0, facet_tests = 0;
};

/// Touch query: repeated queries; a run allocates nothing once its lists have grown. Cost: about 15 ns per sphere and
/// 50...300 ns per facet that it meets; docs/how-to/distance.md has medians.
class TouchQuery {
 public:
  /// The result stays until the next run; its status reports a rejection.
  const Touch& run(const Collider& body, const HalfSpace& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const Sphere& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const Capsule& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const ConvexHull& shape, const TouchOptions& options = {});
  const Touch& result() const { return result_; }

 private:
  Touch result_;
};
/// The same, once. Throws std::invalid_argument, with the message, for rejected input.
Touch touch(const Collider& body, const HalfSpace& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const Sphere& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const Capsule& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const ConvexHull& shape, const TouchOptions& options = {});

/// The points origin + t direction, 0 <= t <= t_end. {p, q - p, 1} is the segment from p to q.
struct Ray {
  /// The largest |component| of the direction is above 2^-200 and below 2^200, so that t stays in range.
  Vec3 origin{}, direction{0, 0, 1};
  double t_end = std::numeric_limits<double>::infinity();
};

/// A point where a ray meets the surface.
struct RayPoint {
  double t = 0;          ///< parameter, in lengths of the direction
  SurfacePoint point{};  ///< the point, on the lowest facet of those hit at the same t
  Vec3 normal{};  ///< outward unit normal of the facet; opposite to the direction where the ray enters; 0 for a facet
                  ///< without area
};

struct [[nodiscard]] RayHit {
  Status status;
  std::optional<RayPoint> first;  ///< first hit; no value is a proof that the ray misses, if `certified`
  bool certified = false;         ///< SphereState::covers of the body
  std::size_t sphere_tests = 0, facet_tests = 0;
};

/// Ray query: the first facet that the ray hits.
///
/// The test is watertight [woop2013]. Facets are sheared so that the ray becomes an axis; each vertex has the same
/// sheared coordinates in all its facets, and the sides of edges and corners are decided exactly. So no ray slips
/// through between adjacent facets; it hits the surface with vertices moved by less than 2^-48 of their largest
/// |coordinate|. A facet seen edge-on is hit only if its neighbors are. Cost: 15 ns per sphere, 40 ns per facet.
class RayQuery {
 public:
  /// Finds the first hit. The status reports a fault. Allocates nothing.
  RayHit run(const Collider& body, const Ray& ray) const;
};
/// The same, once. Throws std::invalid_argument, with the message, for rejected input.
RayHit first_hit(const Collider& body, const Ray& ray);

}  // namespace morula
