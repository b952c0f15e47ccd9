// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Sweeps: a ball, a capsule or a convex hull that moves by a translation, against one body: when and where it touches
// first, such as a projectile, a tool or a foot of a character.
//
//   const morula::Sphere ball{{0, 0, 5}, 0.1};
//   const morula::SweepHit hit = morula::sweep(body, ball, {0, 0, -10});
//   if (hit.first) std::printf("facet %u after %g of the way\n", hit.first->point.facet, hit.first->t);
//   const morula::ConvexHull box = morula::ConvexHull::box({{-1, -1, 4}, {1, 1, 5}});   // any box, with a transform
//   if (!morula::sweep(body, box, {0, 0, -10}).first) std::puts("the box passes");
#pragma once

#include <morula/collide/primitives.hpp>
#include <optional>

namespace morula {

/// The first touch of a moving shape and a surface.
struct SweepPoint {
  double t = 0;  ///< share of the motion before the touch: 0 to 1; 0 if the shape touches where it starts
  SurfacePoint
      point{};    ///< point of the surface that the shape touches; the lowest one of facets with the same bits of t
  Vec3 normal{};  ///< unit normal out of the shape at the point, when it touches
};

/// The result of a sweep.
struct [[nodiscard]] SweepHit {
  Status status;
  std::optional<SweepPoint> first;  ///< first touch; no value: the shape passes, which is proven if `certified`
  bool certified = false;           ///< SphereState::covers of the body
  std::size_t sphere_tests = 0, facet_tests = 0;  ///< number of spheres, and of facets, that were tested
};

/// Finds the first touch of a shape that starts at its own place and moves by `motion`, without rotation. The body
/// stays at its present pose; the query is about its surface, as TouchQuery is.
///
/// `t` is the end of a proof: up to it, directions separate the shape from every facet. So it is never later than the
/// touch, up to rounding. When it ends, the shape is within 2^-38 of the largest |coordinate| of shape, body and motion
/// of the surface. A shape that passes the surface nearer than that may be reported.
///
/// Allocates nothing, except as Collider says. Several threads may call it at once. Cost: about 100 ns per sphere, and
/// 1 to 5 us per facet, along the way up to the touch; for a convex hull times its facets.
class SweepQuery {
 public:
  /// t_end: end of the search, 0 to 1. Rejects a body that queries reject, a collider without facets, positions of
  /// another frame than the spheres, and with bad_shape a shape that TouchQuery rejects, and a motion that is not
  /// finite or 2^200 or more; with bad_option a t_end that is not in range.
  SweepHit run(const Collider& body, const Sphere& shape, const Vec3& motion, double t_end = 1) const;
  SweepHit run(const Collider& body, const Capsule& shape, const Vec3& motion, double t_end = 1) const;
  SweepHit run(const Collider& body, const ConvexHull& shape, const Vec3& motion, double t_end = 1) const;
};
/// The result of SweepQuery::run(), for a single call. Throws std::invalid_argument, with the message of the status,
/// for input that it rejects.
SweepHit sweep(const Collider& body, const Sphere& shape, const Vec3& motion);
SweepHit sweep(const Collider& body, const Capsule& shape, const Vec3& motion);
SweepHit sweep(const Collider& body, const ConvexHull& shape, const Vec3& motion);

}  // namespace morula
