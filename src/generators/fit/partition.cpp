// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/partition.hpp"

#include <morula/geometry/enclosing_sphere.hpp>
#include <numeric>

namespace morula {

Partition partition(const Mesh& mesh, const Region& region, std::span<const Sphere> spheres) {
  Partition result;
  result.regions.resize(spheres.size());
  std::vector<std::uint32_t> all(spheres.size());
  std::iota(all.begin(), all.end(), 0u);

  Region leftovers;
  CutFacet cut;
  std::vector<Vec3> points;
  for (std::size_t k = 0; k < region.size(); ++k) {
    const FacetGeometry facet = facet_geometry(mesh, region.facet[k]);
    cut.clear();
    cut_by_power(facet, region.polygon(k), spheres, all, cut);
    for (std::size_t piece = 0; piece < cut.size(); ++piece) {
      const Sphere& own = spheres[cut.owner[piece]];
      double farthest = 0;
      for (const Barycentric& b : cut.polygon(piece))
        farthest = std::max(farthest, squared_distance(own.center, at_barycentric(facet.corners, b)));
      Region& target = farthest <= own.radius * own.radius ? result.regions[cut.owner[piece]] : leftovers;
      target.add(region.facet[k], cut.polygon(piece));
    }
  }

  result.leftover_patches = leftovers.size();
  std::vector<Sphere> grown(spheres.begin(), spheres.end());
  for (std::size_t k = 0; k < leftovers.size(); ++k) {
    const Triangle corners = mesh.corners(leftovers.facet[k]);
    points.clear();
    for (const Barycentric& b : leftovers.polygon(k)) points.push_back(at_barycentric(corners, b));
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < grown.size(); ++i) {
      const double growth = farthest_distance(grown[i].center, points) - grown[i].radius;
      if (growth < least) least = growth, best = i;
    }
    grown[best].radius += std::max(0.0, least);
    result.regions[best].add(leftovers.facet[k], leftovers.polygon(k));
  }
  return result;
}

}  // namespace morula
