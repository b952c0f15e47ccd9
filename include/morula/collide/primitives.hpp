// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Simple shapes against a body: a floor, a tool, a haptic probe, a picking ray.
//
// All of these are about the body's surface, not its interior: a sphere that floats inside a closed body without
// reaching a wall touches nothing. What is inside, InsideQuery tells (containment.hpp). Open surfaces are as good as
// closed ones. Shapes are in the world; a body is where its collider is placed.
#pragma once

#include <limits>
#include <morula/collide/collider.hpp>
#include <morula/collide/convex_hull.hpp>
#include <morula/geometry/triangle.hpp>
#include <optional>
#include <vector>

namespace morula {

/// The half space normal . x <= offset: everything behind a plane. The normal may have any length but 0.
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
  /// What is this far outside the shape still touches it; negative: it has to be that deep inside.
  double margin = 0;
  bool nearest = false;        ///< look for the nearest point of the surface even if it is farther than the margin
  bool stop_at_first = false;  ///< stop at the first facet that touches: a yes or no
  bool collect_all = false;    ///< every facet that touches, and the leaves that own parts of them
};

/// Where a facet is deepest in the shape.
struct TouchingFacet {
  SurfacePoint point{};
  /// Of the point inside the shape; negative outside. Of a capsule at most its radius: behind its axis depth falls
  /// again.
  double depth = 0;
  Vec3 normal{};  ///< unit, out of the shape at the point; on a capsule's axis or a sphere's center, into the body
};

struct [[nodiscard]] Touch {
  Status status;
  bool touches = false;  ///< the depth found, in double, is -margin or more
  /// Proof that no point of the surface is within the margin. Where the surface only just touches, up to rounding, both
  /// may be false.
  bool proven_clear = false;
  bool certified = false;  ///< SphereState::covers of the body; else `proven_clear` and `lower` are no proofs
  /// The surface's signed distance to the shape (negative inside) is lower or more. Near the depth found, or above the
  /// margin when `proven_clear`; with `stop_at_first` looser.
  double lower = 0;
  /// Something within the margin, or with `nearest` anything: the lowest facet of equals; with `stop_at_first` the
  /// first one met.
  std::optional<TouchingFacet> deepest;
  std::vector<TouchingFacet> facets;  ///< with `collect_all`: ascending, each once, each with its own deepest point
  /// With `collect_all`: the leaves that own a part of these and whose spheres reach the shape.
  std::vector<std::uint32_t> leaves;
  std::size_t sphere_tests = 0, facet_tests = 0;
};

/// Touch query: asks again and again; a run allocates nothing once its lists have grown. Cost: that of the spheres and
/// facets met, some 15 ns and 50...300 ns each; docs/how-to/distance.md has medians.
class TouchQuery {
 public:
  /// The result stays until the next run; its status says what was refused.
  const Touch& run(const Collider& body, const HalfSpace& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const Sphere& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const Capsule& shape, const TouchOptions& options = {});
  const Touch& run(const Collider& body, const ConvexHull& shape, const TouchOptions& options = {});
  const Touch& result() const { return result_; }

 private:
  Touch result_;
};
/// The same, once. Throws std::invalid_argument, in words, for what is refused.
Touch touch(const Collider& body, const HalfSpace& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const Sphere& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const Capsule& shape, const TouchOptions& options = {});
Touch touch(const Collider& body, const ConvexHull& shape, const TouchOptions& options = {});

/// The points origin + t direction, 0 <= t <= t_end. A segment from p to q: {p, q - p, 1}.
struct Ray {
  Vec3 origin{}, direction{0, 0, 1};  ///< of any length but 0
  double t_end = std::numeric_limits<double>::infinity();
};

/// Where a ray meets the surface.
struct RayPoint {
  double t = 0;          ///< in lengths of the direction
  SurfacePoint point{};  ///< the lowest facet of those hit at the same t
  Vec3 normal{};         ///< of the facet, unit, outward; against the direction where the ray enters; 0 without area
};

struct [[nodiscard]] RayHit {
  Status status;
  std::optional<RayPoint> first;  ///< nothing: proof that the ray misses, when `certified`
  bool certified = false;         ///< SphereState::covers of the body
  std::size_t sphere_tests = 0, facet_tests = 0;
};

/// Ray query: the first facet that the ray hits.
///
/// Watertight [woop2013]: facets are sheared so that the ray becomes an axis, each vertex to the same double
/// coordinates for all its facets, and there the sides of edges are decided exactly, edges and corners included. So no
/// ray slips through between facets that share them; it hits the surface with vertices moved by less than 2^-48 of
/// their largest |coordinate|. A facet seen edge-on is hit only where its neighbors are. Cost: 15 ns per sphere, 40 ns
/// per facet.
class RayQuery {
 public:
  /// A fault is reported in the status. No allocation.
  RayHit run(const Collider& body, const Ray& ray) const;
};
/// The same, once. Throws std::invalid_argument, in words, for what is refused.
RayHit first_hit(const Collider& body, const Ray& ray);

}  // namespace morula
