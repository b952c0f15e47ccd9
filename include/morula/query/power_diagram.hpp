// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The power diagram of spheres, cut into facets: the basis of every partition and every certificate.
//
// Cell i is the set of points x at which the power |x − c_i|² − r_i² is least for sphere i. The difference of two
// powers is affine, so a facet is divided into convex polygons. On its own cell a sphere's power is the least of all,
// and it is convex. Hence spheres cover a surface if and only if every polygon's corners lie in the polygon's own
// sphere.
#pragma once

#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <span>
#include <vector>

namespace morula {

/// Convex polygons inside one facet, with their owners. Each cut clears and refills it; reuse avoids allocation.
struct CutFacet {
  std::vector<Barycentric> corners;
  std::vector<std::uint32_t> corner_begin{0};  ///< polygon k has corners [corner_begin[k], corner_begin[k + 1])
  std::vector<std::uint32_t> owner;            ///< index of the owning sphere

  std::size_t size() const { return owner.size(); }
  std::span<const Barycentric> polygon(std::size_t k) const {
    return std::span(corners).subspan(corner_begin[k], corner_begin[k + 1] - corner_begin[k]);
  }
  void clear() {
    corners.clear();
    corner_begin.assign(1, 0);
    owner.clear();
  }
};

/// A facet, with vertex indices that make its cuts agree bit for bit with those of its neighbors: they give each mesh
/// edge a direction that is the same from both sides.
struct FacetGeometry {
  Triangle corners;
  std::array<std::uint32_t, 3> vertices;
};

/// Cuts one convex polygon of a facet by the power diagram of a few spheres.
///
/// polygon: barycentric corners in order, at least 3. candidates: indices of spheres that may own a part, not empty.
/// Appends polygons to `cut` that tile the input: both sides share every cut, so they tile under any rounding. The
/// owner of each polygon has the least power at all its corners, up to rounding; ties go to the lower index. A facet
/// with a repeated vertex is never cut. Cost: O(candidates × polygons).
void cut_by_power(const FacetGeometry& facet, std::span<const Barycentric> polygon, std::span<const Sphere> spheres,
                  std::span<const std::uint32_t> candidates, CutFacet& cut);

/// An index over many spheres that finds the few spheres whose cells can meet a facet.
class PowerDiagram {
 public:
  /// spheres: at least one; borrowed, so they must outlive the index. Cost: O(n log n).
  explicit PowerDiagram(std::span<const Sphere> spheres);

  /// Finds spheres whose cell may meet the triangle, ascending; they always include the true owners.
  void candidates(const Triangle& triangle, std::vector<std::uint32_t>& found) const;
  /// Cuts the whole facet into cells.
  void cut(const FacetGeometry& facet, std::vector<std::uint32_t>& scratch, CutFacet& cut) const;
  /// The sphere of least power at x; the lowest index among equals.
  std::uint32_t owner(const Vec3& x) const;

  struct Growth {
    std::uint32_t sphere;
    double amount;  ///< max over the points of |x − c| − r, mesh units; negative if the sphere contains all of them
  };
  /// The sphere that needs the least growth of its radius to contain all points; the lowest index among equals. For one
  /// point the amount is its signed distance to the union's nearest sphere. points: at least one.
  Growth least_growth(std::span<const Vec3> points) const;

 private:
  struct Node {
    Vec3 lower, upper;  // box of the centers
    double largest_radius;
    std::uint32_t begin, end;  // range in order_
    std::uint32_t left;        // children are left and left + 1; 0 for a leaf
  };
  void split(std::uint32_t node);

  std::span<const Sphere> spheres_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// PowerDiagram::least_growth for a few spheres, without an index. spheres: at least one.
PowerDiagram::Growth least_growth(std::span<const Sphere> spheres, std::span<const Vec3> points);

}  // namespace morula
