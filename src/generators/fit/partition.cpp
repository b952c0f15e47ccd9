// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/fit/partition.hpp"

#include <algorithm>
#include <morula/geometry/enclosing_sphere.hpp>
#include <numeric>
#include <span>

#include "query/power_cell_of.hpp"
#include "tree/vertex_memo.hpp"

namespace morula::detail {
namespace {

// The owner of a vertex by power, and whether that sphere contains it.
struct VertexOwner {
  std::uint32_t sphere;
  bool is_inside;
};

bool contains(const Sphere& sphere, const Vec3& x) {
  return squared_distance(sphere.center, x) <= sphere.radius * sphere.radius;
}

}  // namespace

Partition partition(const MeshView& mesh, const Region& region, std::span<const Sphere> spheres) {
  Partition result;
  result.regions.resize(spheres.size());
  std::vector<std::uint32_t> all(spheres.size());
  std::iota(all.begin(), all.end(), 0u);

  Region leftovers;
  CutFacet cut;
  std::vector<Vec3> points;
  VertexMemo<VertexOwner> owners(region.size());
  const auto owner_of = [&](std::uint32_t v) {
    return owners.of(v, [&] {
      const Vec3& x = mesh.positions[v];
      const std::uint32_t owner = power_cell_of(x, spheres, all);
      return VertexOwner{owner, contains(spheres[owner], x)};
    });
  };
  for (std::size_t k = 0; k < region.size(); ++k) {
    if (region.is_whole(k)) {
      // Differences of powers are affine: the common owner of all three corners owns the facet.
      const auto& [a, b, c] = mesh.facets[region.facet[k]];
      const VertexOwner at_a = owner_of(a), at_b = owner_of(b), at_c = owner_of(c);
      // mutant partition-two-corners: `at_b.sphere && at_b.sphere == at_c.sphere` -> `at_b.sphere`
      if (at_a.sphere == at_b.sphere && at_b.sphere == at_c.sphere) {
        const bool is_inside = at_a.is_inside && at_b.is_inside && at_c.is_inside;
        // mutant partition-whole-unchecked: `(is_inside ... at_a.sphere] : leftovers)` -> `result.regions[at_a.sphere]`
        (is_inside ? result.regions[at_a.sphere] : leftovers).add_whole(region.facet[k]);
        continue;
      }
    }
    const FacetGeometry facet = facet_geometry(mesh, region.facet[k]);
    cut.clear();
    cut_by_power(facet, region.polygon(k), spheres, all, cut);
    for (std::size_t part = 0; part < cut.size(); ++part) {
      const std::span<const Barycentric> polygon = cut.polygon(part);
      const bool is_inside = std::all_of(polygon.begin(), polygon.end(), [&](const Barycentric& b) {
        return contains(spheres[cut.owner[part]], at_barycentric(facet.corners, b));
      });
      Region& target = is_inside ? result.regions[cut.owner[part]] : leftovers;
      target.add(region.facet[k], polygon);
    }
  }

  result.leftover_patches = leftovers.size();
  std::vector<Sphere> grown(spheres.begin(), spheres.end());
  for (std::size_t k = 0; k < leftovers.size(); ++k) {
    const Triangle corners = mesh.corners(leftovers.facet[k]);
    points.clear();
    for (const Barycentric& b : leftovers.polygon(k)) points.push_back(at_barycentric(corners, b));
    // Growth starts from spheres that have grown already: a partition of few spheres may depend on the order of its
    // leftovers; cover(), whose chunks are independent of each other, may not.
    const PowerDiagram::Growth growth = least_growth(grown, points);
    grown[growth.sphere].radius += std::max(0.0, growth.amount);
    result.regions[growth.sphere].add(leftovers.facet[k], leftovers.polygon(k));
  }
  return result;
}

}  // namespace morula::detail
