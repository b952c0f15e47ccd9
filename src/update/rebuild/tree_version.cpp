// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/tree_version.hpp"

#include <utility>

#include "update/rebuild/relative_looseness.hpp"

namespace morula::detail {
namespace {

// Calls take(level, Σ r³ over that level set), from the root. Levels below the tree's last are sets of all leaves.
template <typename Take>
void for_level_sets(const Body& body, std::size_t levels, const Take& take) {
  const SphereTree& tree = body.rest_tree();
  const std::span<const Spheref> spheres = body.spheres();
  double ended = 0;  // sum over leaves of levels above
  for (std::size_t level = 0; level < levels; ++level) {
    double leaves = 0, inner = 0;
    if (level < tree.level_count())
      for (std::uint32_t node = tree.level_begin[level]; node < tree.level_begin[level + 1]; ++node) {
        const double radius = static_cast<double>(spheres[node].radius);
        (tree.is_leaf(node) ? leaves : inner) += radius * radius * radius;
      }
    ended += leaves;
    take(level, ended + inner);
  }
}

}  // namespace

TreeVersion::TreeVersion(Body its_body, const MeshView& posed, LoosenessEstimator& estimator, std::size_t levels)
    : body(std::move(its_body)),
      gauge(posed, body.rest_tree(), body.cover()),
      looseness_at_build(levels),
      looseness_elsewhere(levels),
      cubes_at_build_(levels) {
  estimator.reserve(body.rest_tree().node_count());
  estimator.pose(posed.positions);
  estimator.estimate(body, looseness_at_build);
  // mutant known-object-inside: `(estimator.has_volume() ? 1 : 0)` -> `0`
  taken_up_at_build_ = looseness_at_build.back() + (estimator.has_volume() ? 1 : 0);
  for_level_sets(body, levels, [&](std::size_t level, double cubes) { cubes_at_build_[level] = cubes; });
}

double TreeVersion::growth() const noexcept {
  double all = 0;
  int counted = 0;
  for_level_sets(body, cubes_at_build_.size(), [&](std::size_t level, double cubes) {
    if (level < first_counted_level(cubes_at_build_.size()) || !(cubes_at_build_[level] > 0)) return;
    all += cubes / cubes_at_build_[level];
    ++counted;
  });
  return counted > 0 ? all / counted : 1;
}

}  // namespace morula::detail
