// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/exact_check.hpp"

#include <algorithm>
#include <limits>

#include "shared/options.hpp"

namespace morula::cli {

bool any_promises_cover(const Body& body) {
  for (std::size_t level = 0; level < body.rest_tree().level_count(); ++level) {
    if (covers(body.options(), rule_of_level(body.options().rules, level))) return true;
  }
  return false;
}

Certificate certify_promised_levels(const Body& body, const std::vector<Vec3>& positions, Workers& workers) {
  std::vector<Sphere> spheres;
  body.copy_spheres(spheres);
  const SphereTree& tree = body.rest_tree();
  for (std::size_t level = 0; level < tree.level_count(); ++level) {
    if (covers(body.options(), rule_of_level(body.options().rules, level))) continue;
    // An infinite sphere contains every corner: these nodes cannot fail, nor hide the excess of another.
    for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
      spheres[node].radius = std::numeric_limits<double>::infinity();
    }
  }
  return certify(body.cover(), positions, spheres, workers);
}

}  // namespace morula::cli
