// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signed distance from points to a mesh, negative inside, and the volumes of a ball inside and outside the mesh.
#pragma once

#include <limits>
#include <morula/geometry/connectivity.hpp>
#include <morula/query/triangle_bvh.hpp>

namespace morula {

/// The rule that decides whether a point is inside.
enum class SignMethod {
  pseudo_normal,   ///< by the angle-weighted normal at the nearest vertex, edge or facet [baerentzen2005]; exact on
                   ///< closed, oriented, manifold meshes
  winding_number,  ///< inside if the generalized winding number is above ½: also for open, non-manifold or overlapping
                   ///< meshes, for which it is an estimate
};

/// Signed distances to one mesh. Several threads may call its members at once.
class SignedDistance {
 public:
  /// Selects the method: pseudo_normal if the mesh is closed, oriented and manifold, and if up to a thousand facets
  /// spread over it each have inside on one side and outside on the other; otherwise winding_number. Overlapping
  /// shells, and a shell inside a shell of the same orientation, fail that test. A closed mesh that is inside out is
  /// recognized by its negative volume, and gets the signs of the mesh with reversed facets.
  ///
  /// Copies the required data, so the mesh may be destroyed afterwards. Throws std::invalid_argument for a mesh that
  /// require_usable() or require_usable_scale() rejects. Cost: that of a TriangleBvh and of inspect().
  explicit SignedDistance(const MeshView& mesh, Workers& workers = serial_workers());
  /// Uses the given method for any mesh.
  SignedDistance(const MeshView& mesh, SignMethod method, Workers& workers = serial_workers());

  /// The signed distance of p, mesh units. NaN if p is not finite or has a |coordinate| of 2^200 or more.
  double operator()(const Vec3& p) const { return at(p).distance; }
  struct Result {
    double distance;            ///< signed distance, mesh units: negative inside, 0 on the surface
    ClosestFacetPoint closest;  ///< nearest point of the surface
  };
  /// The signed distance and the nearest point. known: an upper bound of the absolute distance, mesh units, for example
  /// from a nearby point. A good bound makes the search faster; no bound changes the result, and a bound that is too
  /// small makes the search slower.
  Result at(const Vec3& p, double known = std::numeric_limits<double>::infinity()) const;
  /// True if the signed distance of p is below 0; points on the surface are not inside.
  bool is_inside(const Vec3& p) const { return at(p).distance < 0; }

  /// An upper bound of the largest distance by which the ball sticks out of the object, mesh units: its radius plus the
  /// signed distance of its center, or 0 if that is negative. Exact for convex objects.
  double protrusion_bound(const Sphere& ball) const { return std::max(0.0, ball.radius + (*this)(ball.center)); }

  SignMethod method() const { return method_; }
  /// True if the mesh is closed and oriented (MeshReport::has_volume). Otherwise inside is an estimate.
  bool has_volume() const { return has_volume_; }
  /// −1 for a mesh that is inside out, otherwise 1.
  double orientation() const { return orientation_; }
  const TriangleBvh& bvh() const { return bvh_; }

 private:
  // Used by pseudo_normal only, in addition to the normals of facets. A normal is zero if slivers make it meaningless.
  struct Normals {
    std::vector<Vec3> of_vertex;                          // angle-weighted average
    std::vector<std::array<std::uint32_t, 3>> neighbors;  // neighbor across the edge opposite to corner k

    Normals() = default;
    Normals(const MeshView& mesh, const Connectivity& connectivity, Workers& workers);
  };
  struct Sides;
  SignedDistance(const MeshView& mesh, const SignMethod* method, Sides sides, Workers& workers);
  bool separates_sides() const;
  bool decide_inside(const Vec3& p, const ClosestFacetPoint& closest, double distance) const;

  Normals normals_;
  TriangleBvh bvh_;
  SignMethod method_ = SignMethod::winding_number;
  bool has_volume_ = false;
  double orientation_ = 1.0;
};

/// The volume of the part of a ball that is inside the object, mesh units³; 0 for a radius of 0 or less.
///
/// For each facet that meets the ball, the function adds the signed volume of the part of the ball in the cone from the
/// ball's center over the facet, in closed form; other facets enter by their total solid angle. For a closed, oriented
/// mesh the error is about 1e-12 of the ball's volume, for any center, also on edges and vertices; a ball of less than
/// 2^-60 of the mesh's largest |coordinate| counts as a point. For an open mesh the result is the integral of the
/// winding number over the ball, with an error of about 1 % of the ball's volume. Space in several overlapping layers
/// counts once for each, up to the whole ball.
///
/// Throws std::invalid_argument for balls with numbers beyond 2^100. Cost: O(k + log F) for k of F facets that meet the
/// ball.
double inside_volume(const SignedDistance& object, const Sphere& ball);

/// The volume of the part of a ball that is outside the object, mesh units³ (sphere outside volume [wang2006]):
/// volume(ball) − inside_volume(object, ball).
double outside_volume(const SignedDistance& object, const Sphere& ball);

}  // namespace morula
