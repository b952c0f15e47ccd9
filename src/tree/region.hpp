// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Regions while they are being made: convex polygons with barycentric corners, before cut points get their numbers.
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/tree/cover.hpp>
#include <span>
#include <vector>

namespace morula::detail {

struct Region {
  std::vector<std::uint32_t> facet;            // one per polygon
  std::vector<std::uint32_t> corner_begin{0};  // polygon k has corners [corner_begin[k], corner_begin[k + 1])
  std::vector<Barycentric> corners;

  std::size_t size() const { return facet.size(); }
  bool empty() const { return facet.empty(); }
  std::span<const Barycentric> polygon(std::size_t k) const {
    return std::span(corners).subspan(corner_begin[k], corner_begin[k + 1] - corner_begin[k]);
  }
  void add(std::uint32_t of_facet, std::span<const Barycentric> polygon) {
    facet.push_back(of_facet);
    corners.insert(corners.end(), polygon.begin(), polygon.end());
    corner_begin.push_back(static_cast<std::uint32_t>(corners.size()));
  }
};

/// All facets, uncut.
Region whole_surface(const Mesh& mesh);

inline FacetGeometry facet_geometry(const Mesh& mesh, std::uint32_t facet) {
  return {mesh.corners(facet), mesh.facets[facet]};
}

/// Positions of all corners, polygon by polygon, with repetitions.
void corner_positions(const Mesh& mesh, const Region& region, std::vector<Vec3>& points);

/// Numbers the cut points (equal ones once) and lines the regions up in the order of the leaves, depth first.
/// regions: one per node; those of inner nodes are ignored.
Cover assemble_cover(const Mesh& mesh, const SphereTree& tree, std::span<const Region> regions);

}  // namespace morula::detail
