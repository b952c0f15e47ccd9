// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The power diagram of spheres, and the cuts of facets by it: the basis of every division of a surface among spheres.
//
// Cell i of the diagram is the set of points x at which the power |x − c_i|² − r_i² is least for sphere i. The
// difference of two powers is an affine function of x, so the cells cut a facet into convex polygons. In its own cell,
// a sphere contains every point that any sphere contains. A sphere is convex, so the spheres cover a surface if and
// only if the corners of every polygon lie in the sphere of its cell.
#pragma once

#include <cstdint>
#include <morula/geometry/sphere.hpp>
#include <morula/geometry/triangle.hpp>
#include <span>
#include <vector>

namespace morula {

/// Convex polygons inside one facet, each with the sphere that owns it. Reuse for several facets avoids allocations.
struct CutFacet {
  std::vector<Barycentric> corners;            ///< corners of all polygons, in coordinates of the facet
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

/// A facet: the positions and the numbers of its vertices. The numbers give each mesh edge a direction that is the same
/// in both its facets, so the cuts of neighboring facets agree bit for bit on their common edge.
struct FacetGeometry {
  Triangle corners;
  std::array<std::uint32_t, 3> vertices;
};

/// Cuts a convex polygon of a facet by the power diagram of a few spheres, and appends the resulting polygons to `cut`.
///
/// polygon: at least 3 corners, in order, in barycentric coordinates of the facet. candidates: indices of the spheres
/// that may own a part; at least one. The resulting polygons tile the given one in spite of rounding, because the
/// polygons on both sides of a cut share its corners. The owner of each polygon has the least power at all its corners,
/// up to rounding; ties go to the lower index. A facet with a repeated vertex is not cut. Cost: O(candidates ×
/// resulting polygons).
void cut_by_power(const FacetGeometry& facet, std::span<const Barycentric> polygon, std::span<const Sphere> spheres,
                  std::span<const std::uint32_t> candidates, CutFacet& cut);

/// An index over many spheres that finds those whose cells may meet a facet. Several threads may call its const members
/// at once.
class PowerDiagram {
 public:
  /// spheres: at least one. They are borrowed, so they must stay in place as long as the index exists. Cost: O(n log n)
  /// for n spheres.
  explicit PowerDiagram(std::span<const Sphere> spheres);

  /// Writes the indices of spheres whose cells may meet the triangle to `found`, ascending. They include all whose
  /// cells do meet it.
  void candidates(const Triangle& triangle, std::vector<std::uint32_t>& found) const;
  /// Cuts the whole facet, and appends the polygons to `cut`. scratch: memory for candidates, of any content.
  void cut(const FacetGeometry& facet, std::vector<std::uint32_t>& scratch, CutFacet& cut) const;
  /// The index of the sphere of least power at x; the lowest of equals.
  std::uint32_t owner(const Vec3& x) const;

  struct Growth {
    std::uint32_t sphere;
    /// The largest |x − c| − r of the points x, mesh units: the increase of the radius; negative if the sphere contains
    /// all points with room to spare.
    double amount;
  };
  /// The sphere that contains all points after the smallest increase of its radius; the lowest index of equals. For one
  /// point, the amount is the least signed distance from it to a sphere. points: at least one.
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

/// PowerDiagram::least_growth() for a few spheres, without an index. spheres, points: at least one each.
PowerDiagram::Growth least_growth(std::span<const Sphere> spheres, std::span<const Vec3> points);

}  // namespace morula
