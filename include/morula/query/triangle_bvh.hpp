// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A wide bounding volume hierarchy over facets: the one index behind all queries on shapes.
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

/// Its barycentric coordinates are exactly zero on the opposite edge.
struct ClosestFacetPoint : SurfacePoint {
  double squared_distance;
};

class TriangleBvh {
 public:
  /// Copies the required data, so the mesh need not outlive it. The tree is the same for any number of workers. Throws
  /// std::invalid_argument unless the mesh has a usable scale (geometry/scale.hpp). Cost: O(F log F).
  explicit TriangleBvh(const MeshView& mesh, Workers& workers = serial_workers());
  ~TriangleBvh();
  TriangleBvh(TriangleBvh&&) noexcept;
  TriangleBvh& operator=(TriangleBvh&&) noexcept;

  std::size_t facet_count() const;
  /// Bounding box of the corners of all facets.
  const Box& bounding_box() const;
  /// A facet, by its index in the mesh: the positions of its corners, and their vertices.
  Triangle triangle(std::uint32_t facet) const;
  const Facet& corners(std::uint32_t facet) const;

  /// Nearest surface point; no value if all of the surface is farther away than max_distance (which shortens the
  /// search), or if p is not finite or 2^200 or more from the origin along an axis. The lowest index decides among
  /// facets at the same distance.
  std::optional<ClosestFacetPoint> closest_point(const Vec3& p,
                                                 double max_distance = std::numeric_limits<double>::infinity()) const;

  /// Finds facets whose closed triangle meets the closed ball (distance to the center ≤ radius), ascending.
  void facets_touching(const Sphere& ball, std::vector<std::uint32_t>& facets) const;

  /// Generalized winding number of the surface about p: 1 inside a closed outward mesh, 0 outside, in between near
  /// holes, one more for every further layer. [jacobson2013]
  ///
  /// accuracy: a cluster of facets farther away than `accuracy` × its radius counts by the first two terms of its far
  /// field [barill2018]: at 2 a single layer is off by at most about 0.05, at 4 by 0.005; infinity sums every facet. A
  /// facet that contains p counts 0. Cost: about O(log F), and about accuracy² for large accuracy.
  double winding_number(const Vec3& p, double accuracy = 2.0) const;

 private:
  struct Data;
  std::unique_ptr<const Data> data_;
};

}  // namespace morula
