// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signed distance to a mesh, negative inside, and the volumes of a ball inside and outside the mesh.
#pragma once

#include <limits>
#include <morula/geometry/connectivity.hpp>
#include <morula/query/triangle_bvh.hpp>

namespace morula {

/// The rule that separates inside from outside.
enum class SignMethod {
  pseudo_normal,   ///< angle-weighted normals at the closest feature: exact on closed, oriented, manifold meshes
                   ///< [baerentzen2005]
  winding_number,  ///< generalized winding number above ½: a sensible result for open, non-manifold or overlapping
                   ///< meshes
};

class SignedDistance {
 public:
  /// Selects pseudo_normal if the mesh is closed, oriented and manifold, and if it has inside and outside on opposite
  /// sides of a thousand facets spread over it (overlapping shells, and nested shells of the same orientation, do not);
  /// otherwise winding_number. A closed mesh that is inside out is recognized by its negative volume and handled
  /// correctly. Copies the required data, so the mesh need not outlive it. Cost: that of the index and of inspect().
  explicit SignedDistance(const MeshView& mesh, Workers& workers = serial_workers());
  SignedDistance(const MeshView& mesh, SignMethod method, Workers& workers = serial_workers());

  /// Signed distance of p. p must be finite and nearer than 2^200 to the origin along each axis; otherwise the distance
  /// is NaN.
  double operator()(const Vec3& p) const { return at(p).distance; }
  struct Result {
    double distance;  ///< signed distance, mesh units: negative inside; 0 on the surface
    ClosestFacetPoint closest;
  };
  /// Signed distance and nearest point. known: an upper bound of the distance, for example from a sample. It speeds up
  /// the search and does not change the result; if it is too small, the search only takes longer.
  Result at(const Vec3& p, double known = std::numeric_limits<double>::infinity()) const;
  bool is_inside(const Vec3& p) const { return at(p).distance < 0; }

  /// Upper bound of the ball's protrusion out of the object, (r + φ(c))⁺, mesh units: exact for convex objects.
  double protrusion_bound(const Sphere& ball) const { return std::max(0.0, ball.radius + (*this)(ball.center)); }

  SignMethod method() const { return method_; }
  /// True if the mesh is closed and consistently oriented: inside is then a property of the surface, not an estimate.
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

/// Volume of ball ∩ object: the sum, over the facets that meet the ball, of the signed volume of ball ∩ cone(center,
/// facet) in closed form; far facets count through their total solid angle.
///
/// The mesh must be closed and oriented. The error is then about 1e-12 of the ball's volume for any center, even on
/// edges and vertices, if the ball is not smaller than the spacing of its coordinates. For an open mesh the result is
/// the integral of the winding number, to about a percent of the ball. Overlapping layers all count, up to the whole
/// ball. Throws std::invalid_argument for balls with numbers beyond 2^100. Cost: O(k + log F) for k facets that meet
/// the ball.
double inside_volume(const SignedDistance& object, const Sphere& ball);

/// Volume of ball minus object: the sphere outside volume [wang2006].
double outside_volume(const SignedDistance& object, const Sphere& ball);

}  // namespace morula
