// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/partition.hpp"

#include <morula/geometry/enclosing_sphere.hpp>
#include <numeric>

#include "tree/vertex_memo.hpp"

namespace morula::detail {
namespace {

// Whose a point is by power, as cut_by_power decides, and how far it is from that sphere's centre.
struct PointOwner {
  std::uint32_t sphere;
  double squared_distance;
};
PointOwner owner_of(const Vec3& x, std::span<const Sphere> spheres) {
  PointOwner owner{0, squared_distance(spheres[0].center, x)};
  double least = owner.squared_distance - spheres[0].radius * spheres[0].radius;
  for (std::uint32_t i = 1; i < spheres.size(); ++i) {
    const double squared = squared_distance(spheres[i].center, x);
    const double power = squared - spheres[i].radius * spheres[i].radius;
    if (power < least) least = power, owner = {i, squared};
  }
  return owner;
}

}  // namespace

Partition partition(const Mesh& mesh, const Region& region, std::span<const Sphere> spheres) {
  Partition result;
  result.regions.resize(spheres.size());
  std::vector<std::uint32_t> all(spheres.size());
  std::iota(all.begin(), all.end(), 0u);

  Region leftovers;
  CutFacet cut;
  std::vector<Vec3> points;
  VertexMemo<PointOwner> owners(region.size());
  const auto owner_of_vertex = [&](std::uint32_t v) {
    return owners.of(v, [&] { return owner_of(mesh.positions[v], spheres); });
  };
  for (std::size_t k = 0; k < region.size(); ++k) {
    if (region.is_whole(k)) {
      const Facet& f = mesh.facets[region.facet[k]];
      const std::array<PointOwner, 3> of{owner_of_vertex(f[0]), owner_of_vertex(f[1]), owner_of_vertex(f[2])};
      const Sphere& own = spheres[of[0].sphere];
      const double farthest = std::max({of[0].squared_distance, of[1].squared_distance, of[2].squared_distance});
      // Differences of powers are affine: whose all three corners are, theirs is the facet.
      if (of[1].sphere == of[0].sphere && of[2].sphere == of[0].sphere && farthest <= own.radius * own.radius) {
        result.regions[of[0].sphere].add_whole(region.facet[k]);
        continue;
      }
    }
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
