// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Simple shapes against one body: half spaces, balls, capsules, convex hulls and rays, such as a floor, a tool, a
// haptic probe or a picking ray.
//
// These queries are about the surface of the body, not its interior: a ball inside a closed body that does not reach
// the surface touches nothing. InsideQuery tests the interior (containment.hpp). Surfaces may be open. Shapes are in
// world coordinates; bodies are at the transforms of their colliders.
//
//   const morula::Touch floor = morula::touch(a, morula::HalfSpace{.normal = {0, 0, 1}, .offset = 0});
//   if (floor.touches) std::printf("%g below the floor\n", floor.deepest->depth);
//   morula::TouchQuery tool;  // keeps its memory from frame to frame
//   if (tool.run(a, morula::Capsule{{0, 0, 1}, {0, 0, 2}, 0.1}).proven_clear) std::puts("the tool is clear");
//   const morula::RayHit hit = morula::first_hit(a, {.origin = {0, 0, 5}, .direction = {0, 0, -1}});
//   if (hit.first) std::printf("the ray hits facet %u\n", hit.first->point.facet);
//   for (const morula::RayPoint& point : morula::all_hits(a, {.origin = {0, 0, 5}, .direction = {0, 0, -1}}))
//     std::printf("facet %u at %g\n", point.point.facet, point.t);
#pragma once

#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/convex_hull.hpp>
#include <morula/geometry/triangle.hpp>
#include <optional>
#include <vector>

namespace morula {

/// The points x with normal · x ≤ offset: those behind a plane. The normal may have any length except 0; the plane is
/// nearer than 2^200 to the origin.
struct HalfSpace {
  Vec3 normal{0, 0, 1};
  double offset = 0;  ///< mesh units × length of the normal
};
/// The points within a distance `radius` of the segment from p to q; a ball if p = q.
struct Capsule {
  Vec3 p{}, q{};
  double radius = 0;  ///< mesh units; 0 or more
};

struct TouchOptions {
  /// Largest distance from the shape at which the surface counts as touching, mesh units; finite. If it is negative,
  /// the surface must reach at least this far into the shape.
  double margin = 0;
  bool nearest = false;  ///< true: find the point of the surface nearest to the shape, also beyond the margin
  /// true: stop at the first facet that touches, for a yes or no; Touch::deepest is then not the deepest point.
  bool stop_at_first = false;
  /// true: list all facets that touch, and the leaves that own parts of them (Touch::facets, Touch::leaves).
  bool collect_all = false;
};

/// A facet, with its point that is deepest in the shape, or nearest to it.
struct TouchingFacet {
  SurfacePoint point{};
  /// Depth of the point below the surface of the shape, mesh units; negative outside the shape. In a capsule it is at
  /// most the radius, which it has on the axis.
  double depth = 0;
  /// Unit vector out of the shape at the point. On the axis of a capsule or at the center of a ball, where no direction
  /// is special, it points into the body.
  Vec3 normal{};
};

/// The result of a touch query.
struct [[nodiscard]] Touch {
  Status status;
  bool touches = false;  ///< true if the depth of `deepest`, computed in double, is −margin or more
  /// true: it is proven that no point of the surface is within the margin. If the distance is the margin up to
  /// rounding, neither `touches` nor `proven_clear` may be true.
  bool proven_clear = false;
  bool certified = false;  ///< SphereState::covers of the body; if false, `proven_clear` and `lower` are not proven
  /// A lower bound of the surface's signed distance from the shape, negative inside, mesh units: slightly less than
  /// −depth of `deepest`, or above the margin if `proven_clear`. It may be much lower with `stop_at_first`.
  double lower = 0;
  /// The deepest point of the surface within the margin, with `nearest` at any distance; on the lowest facet of equals.
  /// With `stop_at_first` it is a point of the first facet that touches. No value if there is none.
  std::optional<TouchingFacet> deepest;
  /// With `collect_all`: all facets that touch, ascending, each with its own deepest point.
  std::vector<TouchingFacet> facets;
  /// With `collect_all`: the leaves that own a part of these facets and whose spheres reach the shape.
  std::vector<std::uint32_t> leaves;
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< number of spheres, and of facets, that were tested
};

/// Finds where a shape touches a body, again and again. It keeps its memory, so a run allocates only while its lists
/// grow. Only one thread may use it at a time. Cost: about 15 ns per sphere and 50 to 300 ns per facet that it tests;
/// docs/how-to/distance.md has medians.
class TouchQuery {
 public:
  /// Tests one shape against one body. The result is valid until the next run. Rejects a body that queries reject, a
  /// collider without facets, positions of another frame than the spheres, a bad shape and a margin that is not finite;
  /// Touch::status has the reason.
  const Touch& run(const Collider& body, const HalfSpace& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const Sphere& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const Capsule& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const ConvexHull& shape, const TouchOptions& options = {});
  /// The result of the last run.
  const Touch& result() const { return result_; }

 private:
  Touch result_;
};
/// The result of TouchQuery::run(), for a single call. Throws std::invalid_argument, with the message of the status,
/// for input that it rejects.
Touch touch(const Collider& body, const HalfSpace& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const Sphere& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const Capsule& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const ConvexHull& shape, const TouchOptions& options = {});

/// The points origin + t direction with 0 ≤ t ≤ t_end. {p, q - p, 1} is the segment from p to q.
struct Ray {
  Vec3 origin{}, direction{0, 0, 1};                       ///< largest |component| of the direction: 2^-200 to 2^200
  double t_end = std::numeric_limits<double>::infinity();  ///< 0 or more
};

/// A point where a ray meets the surface.
struct RayPoint {
  double t = 0;          ///< parameter of the ray: the distance from its origin in lengths of the direction
  SurfacePoint point{};  ///< the point; if the ray hits several facets at this t, on the lowest one
  /// Outward unit normal of the facet; 0 for a facet without area. Its product with the direction is negative where the
  /// ray enters a body.
  Vec3 normal{};
};

/// The result of a ray query.
struct [[nodiscard]] RayHit {
  Status status;
  std::optional<RayPoint> first;  ///< first hit; no value: the ray misses the surface, which is proven if `certified`
  bool certified = false;         ///< SphereState::covers of the body
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< number of spheres, and of facets, that were tested
};

/// Finds the first facet that a ray hits.
///
/// The test is watertight [woop2013]: no ray passes between adjacent facets. It shears space so that the ray becomes an
/// axis. Each vertex has the same sheared coordinates in all its facets, and the sides of the ray on which edges and
/// vertices lie are decided exactly. The result is exact for a surface whose vertices differ by less than 2^-48 of
/// their largest |coordinate|. A facet parallel to the ray is hit only if its neighbors are. Cost: about 15 ns per
/// sphere and 40 ns per facet.
class RayQuery {
 public:
  /// Finds the first hit. Rejects a body that queries reject, a collider without facets, positions of another frame
  /// than the spheres, and a bad ray. Allocates nothing, except as Collider says. Several threads may call it at once.
  RayHit run(const Collider& body, const Ray& ray) const;
  /// Finds all facets that a ray hits: one point per facet, ascending by t, then by facet. A ray through an edge or a
  /// vertex may hit several facets there. RayHit::first is the first point, as in run(). Rejects like run(), and then
  /// clears `hits`. Allocates only while `hits` grows. Cost: as run(), for all spheres and facets along the ray.
  RayHit run_all(const Collider& body, const Ray& ray, std::vector<RayPoint>& hits) const;
};
/// The points of RayQuery::run_all(), for a single call. Throws std::invalid_argument, with the message of the status,
/// for input that it rejects.
std::vector<RayPoint> all_hits(const Collider& body, const Ray& ray);
/// The result of RayQuery::run(), for a single call. Throws std::invalid_argument, with the message of the status, for
/// input that it rejects.
RayHit first_hit(const Collider& body, const Ray& ray);

}  // namespace morula
