// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "generators/divide/demand.hpp"

#include <cmath>
#include <memory>
#include <morula/query/power_diagram.hpp>

namespace morula::detail {
namespace {

// The square root of a leaf's outside volume, by area. A part with the outside volume κ / n under n spheres and one
// with λ / m do best together if n to m is as √κ to √λ: so roots are shared evenly.
std::vector<float> leaf_demands(const FitInput& input, const CoveredTree& model, std::span<const std::uint32_t> leaves,
                                Workers& workers) {
  std::vector<float> demands(leaves.size());
  workers.run(leaves.size(), [&](std::size_t i) {
    const Sphere& s = model.tree.spheres[leaves[i]];
    Box box;
    box.add(s.center - Vec3{s.radius, s.radius, s.radius});
    box.add(s.center + Vec3{s.radius, s.radius, s.radius});
    OutsideGrid grid(input.lines, box, 0.3 * s.radius);
    const double cost =
        grid.new_outside({grid.to_grid(s.center), static_cast<float>(s.radius / grid.cell())}) * grid.cell_volume();
    double surface = 0;
    for (std::uint32_t p = model.cover.region_begin[leaves[i]]; p < model.cover.region_end[leaves[i]]; ++p) {
      const auto patch = model.cover.patch(p);
      const auto at = [&](std::size_t k) { return corner_position(model.cover, patch[k], input.mesh.positions); };
      for (std::size_t k = 2; k < patch.size(); ++k) surface += area({at(0), at(k - 1), at(k)});
    }
    demands[i] = surface > 0 ? static_cast<float>(std::sqrt(std::max(0.0, cost)) / surface) : 0.0F;
  });
  return demands;
}

struct Leaves {
  std::vector<Sphere> spheres;
  std::vector<float> demands;
  PowerDiagram owners;

  Leaves(std::vector<Sphere> s, std::vector<float> d) : spheres(std::move(s)), demands(std::move(d)), owners(spheres) {}
};

}  // namespace

Demand demand_from(const FitInput& input, const CoveredTree& first, Workers& workers) {
  const std::size_t last = first.tree.level_count() - 1;
  const auto leaves = std::make_shared<const Leaves>(level_set_spheres(first.tree, last),
                                                     leaf_demands(input, first, level_set(first.tree, last), workers));
  return [leaves](const Vec3& p) { return leaves->demands[leaves->owners.owner(p)]; };
}

}  // namespace morula::detail
