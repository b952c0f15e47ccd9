// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// A few points that stand for a patch: one for each sector of the patch about its center of pressure.
//
// Sectors are bounded by half planes through the line along the normal through the center. In the plane of a facet they
// are rays from the point c where the line meets it. With c as the point of the integrals (patch_integrals.hpp), the
// triangles on those rays are 0; so the integrals over a part's share in a sector are sums over the pieces of the part,
// cut at the rays, and no polygon is constructed.
#pragma once

#include <morula/collide/contact_patches.hpp>
#include <vector>

#include "collide/patches/patch_depth.hpp"

namespace morula::detail {

class PatchPoints {
 public:
  /// The force and the moment about the frame's center that the points are to reproduce, in world directions.
  struct Wrench {
    Vec3 force, moment;
  };
  /// Adds up to `count` points. frame: its center is the center of pressure. regions a and b: in this frame. origin:
  /// that of the frame's center.
  void add(const ProjectedRegion& a, const ProjectedRegion& b, const PatchFrame& frame, std::uint32_t count,
           const Wrench& wrench, const std::array<const Collider*, 2>& bodies, const Vec3& origin,
           std::vector<PatchPoint>& points);

 private:
  struct Sector {
    Vec3 weighted;  // sum of positions times areas across the normal
    double area = 0, volume = 0;
    double below = 0;  // area, across the normal, of the facets of both bodies that face against it
  };
  void collect(const ProjectedRegion& region, bool is_a);
  void add_piece(const Vec3& c, const Vec3& p, const Vec3& q, double weight, bool is_a, bool is_below);
  std::size_t sector_of(const Vec3& x) const;

  std::vector<Sector> sectors_;
  std::vector<Vec3> rays_;
  std::vector<double> cuts_;
  std::vector<Vec3> arms_;  // of the points of one patch, from the frame's center
};

}  // namespace morula::detail
