// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/sphere_volumes.hpp"

#include "update/rebuild/relative_looseness.hpp"

namespace morula::detail {
namespace {

// take(level, Σ r³ over that level set), from the root. Levels below the tree's last are sets of all leaves.
template <typename Take>
void for_level_sets(const Body& body, std::size_t levels, const Take& take) {
  const SphereTree& tree = body.rest_tree();
  const std::span<const Spheref> spheres = body.spheres();
  double ended = 0;  // leaves of levels above
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

SphereVolumes::SphereVolumes(const Body& home) : home_(home.rest_tree().level_count()) {
  for_level_sets(home, home_.size(), [&](std::size_t level, double sum) { home_[level] = sum; });
}

double SphereVolumes::of(const Body& body) const noexcept {
  double all = 0;
  for_level_sets(body, home_.size(), [&](std::size_t level, double sum) {
    if (level >= first_counted_level(home_.size()) && home_[level] > 0) all += sum / home_[level];
  });
  return all;
}

}  // namespace morula::detail
