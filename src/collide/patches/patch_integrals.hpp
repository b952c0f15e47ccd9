// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Integrals over the surface of a patch, as sums over the boundary pieces of its facets' parts.
//
// Let P be the part of a facet with unit normal n, p q its pieces with weights w, c any point of its plane. The
// triangles (c, p, q) with their signs make up P, so with s = w / 2 (p - c) x (q - c) and m = (c + p + q) / 3:
//   integral of n over P                      S = sum of s
//   of x x n, for x about o                       sum of m x s
//   of a barycentric coordinate L, times n        sum of L(m) s
// By the divergence theorem the overlap V has, over all parts of both bodies,
//   volume                                        sum of (c - o) . S / 3
//   first moment about o                          sum of the tetrahedra (o, c, p, q): volume (c - o) . s / 3, centroid
//                                                 o + ((c - o) + (p - o) + (q - o)) / 4
// Neither sum depends on o, since the chains of all parts add up to 0 (patch_regions.hpp); o lies in the patch, so
// rounding errors are relative to its size.
//
// Gradient. The volume is the integral of the product of both winding numbers over space. When the vertices v of a move
// by u_v, a point of its surface moves by the sum of L_v u_v, and a's winding number changes only between the old and
// the new surface: to first order, in a layer whose thickness is that sum times n. There b's winding number is the one
// at the surface, except near the loops, which have no area. So the volume changes by the sum of u_v times the integral
// of L_v n over the region, weighted with b's winding number: that integral is the gradient.
//
// Continuity. While all vertices move by at most e, winding numbers change only within e of the surfaces. The volume of
// that set vanishes with e, so the volume of the overlap is a continuous function of all positions.
#pragma once

#include <array>
#include <morula/collide/contact_patches.hpp>
#include <morula/geometry/box.hpp>
#include <span>
#include <vector>

#include "collide/patches/patch_regions.hpp"

namespace morula::detail {

/// The results of one body for all patches.
struct SideResult {
  std::vector<PatchFacet> facets;
  std::vector<VertexGradient> gradients;
  std::vector<std::size_t> facets_begin, gradients_begin;  ///< by patch, and their ends
};

/// The integrals over one patch, positions about the origin of its points.
struct PatchIntegrals {
  Vec3 reference;  ///< a point of the patch, about which moments are summed
  double volume = 0;
  Vec3 first_moment;    ///< of the volume
  Vec3 surface_moment;  ///< first moment of the pieces' triangles, weighted with sizes of areas
  double surface = 0;   ///< sum of these weights
  /// The largest error of the volume by rounding, with a factor of 10 to spare.
  double volume_rounding = 0;
  Box box;                                  ///< of all points, about the reference point
  std::array<Vec3, 2> area_vector, moment;  ///< of each side
  std::array<double, 2> area{};
  /// Area of each side times the winding number of the other body around it, and the largest error of this by rounding,
  /// with a factor of 1,000 to spare. Where no winding number is below 0, neither is this, up to rounding.
  std::array<double, 2> wound_area{}, rounding{};
};

/// The centroid about the reference point: in the box of the points, and that of the surface where the volume is one
/// of rounding errors.
Vec3 centroid_of(const PatchIntegrals& sums);

/// The parts of a patch.
std::span<const FacetPart> parts_of(const SurfaceRegion& region, std::uint32_t patch);

class PatchIntegrator {
 public:
  /// Adds facets and gradients of the patch to the results.
  PatchIntegrals integrate(const PatchRegions& regions, std::uint32_t patch, std::array<SideResult, 2>& results);

 private:
  void add(const PatchRegions& regions, std::size_t which, const FacetPart& part, PatchIntegrals& sums,
           SideResult& result);
  // By side and vertex: the patch that set the place last, and the place in `gradients`.
  std::array<std::vector<std::uint64_t>, 2> stamp_;
  std::array<std::vector<std::size_t>, 2> place_;
  std::uint64_t now_ = 0;
};

}  // namespace morula::detail
