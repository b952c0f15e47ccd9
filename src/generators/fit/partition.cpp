// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/partition.hpp"

#include <morula/geometry/enclosing_sphere.hpp>
#include <numeric>

namespace morula::detail {

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
    // Of spheres that have grown already: a partition of few spheres may well take the order of its leftovers into
    // account, where cover(), whose chunks know nothing of each other, may not.
    const PowerDiagram::Growth growth = least_growth(grown, points);
    grown[growth.sphere].radius += std::max(0.0, growth.amount);
    result.regions[growth.sphere].add(leftovers.facet[k], leftovers.polygon(k));
  }
  return result;
}

}  // namespace morula::detail
