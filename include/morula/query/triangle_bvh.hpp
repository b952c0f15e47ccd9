// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A wide bounding volume hierarchy over facets: the one index that every shape question goes through.
#pragma once

#include <limits>
#include <memory>
#include <morula/geometry/box.hpp>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <morula/parallel/workers.hpp>
#include <optional>
#include <vector>

namespace morula {

/// Its barycentric coordinates are exactly zero where the point lies on an edge or a vertex.
struct ClosestFacetPoint : SurfacePoint {
  double squared_distance;
};

class TriangleBvh {
 public:
  /// Copies what it needs; the mesh may go. Same tree for any number of workers. Throws std::invalid_argument unless
  /// the mesh has a usable scale (geometry/scale.hpp). Cost: O(F log F).
  explicit TriangleBvh(const MeshView& mesh, Workers& workers = serial_workers());
  ~TriangleBvh();
  TriangleBvh(TriangleBvh&&) noexcept;
  TriangleBvh& operator=(TriangleBvh&&) noexcept;

  std::size_t facet_count() const;
  /// Of the corners of all facets.
  const Box& bounding_box() const;
  /// A facet, by its index in the mesh: where its corners are, and which vertices.
  Triangle triangle(std::uint32_t facet) const;
  const Facet& corners(std::uint32_t facet) const;

  /// Nearest surface point, or nothing if all of the surface is farther than max_distance (an early out: "only tell me
  /// if nearer than this"), or p is not finite or 2^200 or more from the origin along an axis. Among facets at the same
  /// distance, the one with the lowest index.
  std::optional<ClosestFacetPoint> closest_point(const Vec3& p,
                                                 double max_distance = std::numeric_limits<double>::infinity()) const;

  /// Facets whose closed triangle meets the closed ball (distance to the center ≤ radius), in ascending order.
  void facets_touching(const Sphere& ball, std::vector<std::uint32_t>& facets) const;

  /// Generalized winding number of the surface about p: 1 inside a closed outward mesh, 0 outside, in between near
  /// holes, one more for every further layer. [jacobson2013]
  ///
  /// accuracy: a cluster of facets farther than `accuracy` × its radius counts by the first two terms of its far field
  /// [barill2018]: at 2 a single layer is off by at most about 0.05, at 4 by 0.005; infinity sums every facet.
  /// On a facet the facet itself counts 0. Cost about O(log F), and about accuracy² for large accuracy.
  double winding_number(const Vec3& p, double accuracy = 2.0) const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace morula
