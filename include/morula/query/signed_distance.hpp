// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Signed distance to a mesh: negative inside.
#pragma once

#include <morula/query/triangle_bvh.hpp>

namespace morula {

/// How inside is told from outside.
enum class SignMethod {
  pseudo_normal,   ///< angle-weighted normals at the closest feature: exact on closed, oriented, manifold meshes [baerentzen2005]
  winding_number,  ///< generalised winding number above ½: a sensible answer on open, non-manifold or overlapping meshes
};

class SignedDistance {
 public:
  /// Chooses pseudo_normal when the mesh is closed, oriented and manifold in a single shell per component, else
  /// winding_number. An inside-out closed mesh is recognised by its negative volume and read the right way round.
  explicit SignedDistance(const Mesh& mesh, Workers& workers = serial_workers());
  SignedDistance(const Mesh& mesh, SignMethod method, Workers& workers = serial_workers());

  double operator()(const Vec3& p) const { return at(p).distance; }
  struct Result {
    double distance;  ///< negative inside; 0 on the surface
    ClosestFacetPoint closest;
  };
  Result at(const Vec3& p) const;
  bool is_inside(const Vec3& p) const { return at(p).distance < 0; }

  /// Upper bound of how far the ball sticks out of the object, (r + φ(c))⁺: exact for convex objects (ALGORITHMS A.4).
  double protrusion_bound(const Sphere& ball) const { return std::max(0.0, ball.radius + (*this)(ball.center)); }

  SignMethod method() const { return method_; }
  const TriangleBvh& bvh() const { return bvh_; }

 private:
  void prepare_normals(const Mesh& mesh);

  TriangleBvh bvh_;
  SignMethod method_;
  double orientation_ = 1.0;               // −1 for an inside-out mesh
  std::vector<Facet> facets_;              // for the pseudo-normals of vertices and edges
  std::vector<Vec3> facet_normals_;        // unit, one per facet
  std::vector<Vec3> vertex_normals_;       // angle-weighted sum, one per vertex
  std::vector<std::array<Vec3, 3>> edge_normals_;  // per facet, edge k is opposite to corner k; sum of the two unit normals
};

}  // namespace morula
