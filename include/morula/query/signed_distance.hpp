// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signed distance to a mesh: negative inside.
#pragma once

#include <limits>
#include <morula/geometry/connectivity.hpp>
#include <morula/query/triangle_bvh.hpp>

namespace morula {

/// How inside is told from outside.
enum class SignMethod {
  pseudo_normal,   ///< angle-weighted normals at the closest feature: exact on closed, oriented, manifold meshes
                   ///< [baerentzen2005]
  winding_number,  ///< generalized winding number above ½: a sensible answer on open, non-manifold or overlapping
                   ///< meshes
};

class SignedDistance {
 public:
  /// Chooses pseudo_normal when the mesh is closed, oriented and manifold, and at a thousand facets spread over it one
  /// side is inside and the other outside (shells that overlap, or nest without turning, fail here); else
  /// winding_number. An inside-out closed mesh is recognized by its negative volume and read the right way round.
  /// Copies what it needs; the mesh may go. Cost: that of the index and of inspect().
  explicit SignedDistance(const MeshView& mesh, Workers& workers = serial_workers());
  SignedDistance(const MeshView& mesh, SignMethod method, Workers& workers = serial_workers());

  /// p must be finite, and nearer than 2^200 to the origin along each axis; what is not is NaN away.
  double operator()(const Vec3& p) const { return at(p).distance; }
  struct Result {
    double distance;  ///< negative inside; 0 on the surface
    ClosestFacetPoint closest;
  };
  /// known: surface is no farther than that from p, as the caller knows (from a sample, say). The result is the same,
  /// found sooner; where no surface is that near it takes longer, no more.
  Result at(const Vec3& p, double known = std::numeric_limits<double>::infinity()) const;
  bool is_inside(const Vec3& p) const { return at(p).distance < 0; }

  /// Upper bound of how far the ball sticks out of the object, (r + φ(c))⁺: exact for convex objects.
  double protrusion_bound(const Sphere& ball) const { return std::max(0.0, ball.radius + (*this)(ball.center)); }

  SignMethod method() const { return method_; }
  /// Closed and consistently oriented: inside is a property of the surface, not a guess.
  bool has_volume() const { return has_volume_; }
  /// −1 for an inside-out mesh, else 1.
  double orientation() const { return orientation_; }
  const TriangleBvh& bvh() const { return bvh_; }

 private:
  // For pseudo_normal only, beside the normals of facets. One is zero where slivers make it meaningless.
  struct Normals {
    std::vector<Vec3> of_vertex;                          // angle-weighted average
    std::vector<std::array<std::uint32_t, 3>> neighbors;  // the facet across the edge opposite to corner k

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

}  // namespace morula
