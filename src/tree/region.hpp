// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Regions during a build: convex polygons with barycentric corners, before cut points get their numbers.
#pragma once

#include <algorithm>
#include <morula/geometry/mesh.hpp>
#include <morula/tree/cover.hpp>
#include <optional>
#include <span>
#include <vector>

namespace morula::detail {

// Whole facets take 8 bytes each; on fine meshes most facets are whole.
class Region {
 public:
  std::vector<std::uint32_t> facet;  // one per polygon

  std::size_t size() const { return facet.size(); }
  bool empty() const { return facet.empty(); }
  bool is_whole(std::size_t k) const { return cut_corner_count(k) == 0; }
  std::span<const Barycentric> polygon(std::size_t k) const {
    if (is_whole(k)) return whole_facet;
    return std::span(cut_corners_).subspan(cut_begin_[k], cut_corner_count(k));
  }
  std::size_t corner_count() const { return cut_corners_.size() + whole_count_ * whole_facet.size(); }
  /// Corners of a polygon that is cut; 0 for a whole facet.
  std::size_t cut_corner_count(std::size_t k) const { return cut_begin_[k + 1] - cut_begin_[k]; }
  void reserve(std::size_t polygons, std::size_t cut_corners) {
    facet.reserve(polygons);
    cut_begin_.reserve(polygons + 1);
    cut_corners_.reserve(cut_corners);
  }
  void add_whole(std::uint32_t of_facet) {
    facet.push_back(of_facet);
    cut_begin_.push_back(cut_begin_.back());
    ++whole_count_;
  }
  void add(std::uint32_t of_facet, std::span<const Barycentric> polygon) {
    if (std::equal(polygon.begin(), polygon.end(), whole_facet.begin(), whole_facet.end())) return add_whole(of_facet);
    facet.push_back(of_facet);
    cut_corners_.insert(cut_corners_.end(), polygon.begin(), polygon.end());
    cut_begin_.push_back(static_cast<std::uint32_t>(cut_corners_.size()));
  }
  /// Adds polygon k of another region.
  void add(const Region& other, std::size_t k) { add(other.facet[k], other.polygon(k)); }

 private:
  // Polygon k has corners [cut_begin_[k], cut_begin_[k + 1]); none if it is whole.
  std::vector<std::uint32_t> cut_begin_{0};
  std::vector<Barycentric> cut_corners_;
  std::size_t whole_count_ = 0;
};

/// All facets, uncut.
Region whole_surface(const MeshView& mesh);

inline FacetGeometry facet_geometry(const MeshView& mesh, std::uint32_t facet) {
  return {mesh.corners(facet), mesh.facets[facet]};
}

/// Calls visit(position) for every corner of a polygon, in order.
template <class Visit>
void each_corner(const MeshView& mesh, const Region& region, std::size_t k, const Visit& visit) {
  const Triangle t = mesh.corners(region.facet[k]);
  if (region.is_whole(k))
    for (const Vec3& corner : t) visit(corner);
  else
    for (const Barycentric& b : region.polygon(k)) visit(at_barycentric(t, b));
}

/// The area of one polygon added to `before`, triangle by triangle.
inline double area_with(double before, const MeshView& mesh, const Region& region, std::size_t k) {
  const Triangle t = mesh.corners(region.facet[k]);
  if (region.is_whole(k)) return before + area(t);
  const auto polygon = region.polygon(k);
  const Vec3 first = at_barycentric(t, polygon[0]);
  for (std::size_t c = 2; c < polygon.size(); ++c)
    before += area({first, at_barycentric(t, polygon[c - 1]), at_barycentric(t, polygon[c])});
  return before;
}

/// Positions of all corners, polygon by polygon; most corners that whole facets share occur once.
void corner_positions(const MeshView& mesh, const Region& region, std::vector<Vec3>& points);

/// Every n-th of all corners with repetitions, polygon by polygon; n is 1, or more if they are `most` or more.
std::vector<Vec3> some_corner_positions(const MeshView& mesh, const Region& region, std::size_t most);

/// Barycentric position of a cover's corner on a facet; nothing if it lies elsewhere. facet: of three different
/// vertices.
std::optional<Barycentric> barycentric_on(const Cover& cover, const Facet& facet, std::uint32_t corner);

/// Numbers the cut points (equal ones once) and stores the regions in the order of the leaves, depth first. regions:
/// one per node; those of inner nodes are ignored.
Cover assemble_cover(const MeshView& mesh, const SphereTree& tree, std::vector<Region> regions);

}  // namespace morula::detail
