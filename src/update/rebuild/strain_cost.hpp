// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// What strain is expected to cost a tree: by how much it raises its relative looseness.
#pragma once

#include <morula/geometry/positions.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <span>

#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Below this, strain says nothing about what it costs.
inline constexpr double least_strain = 0.02;

class StrainCost {
 public:
  /// Until something is measured: what is usual. home: borrowed.
  explicit StrainCost(const TreeVersion& home);

  /// From how loose trees are at each other's poses; poses[0] is rest, poses[k + 1] that of known[k].
  void calibrate(TreeVersion& home, std::span<const TreeVersion> known, std::span<const PositionView> poses,
                 LoosenessEstimator& estimator, Workers& workers);
  /// From what was measured last of this one, which strain_elsewhere tells.
  void learn_from(const TreeVersion& tree) noexcept { per_strain_ = of(tree); }

  /// For a little strain, over that strain.
  double of(const TreeVersion& tree) const noexcept;
  /// The same, where the tree is as loose as that at a strain from the pose that it was built for.
  double of(const TreeVersion& tree, std::span<const double> looseness, double strain) const noexcept;
  /// By how much so much strain raises its relative looseness.
  double at(const TreeVersion& tree, double strain) const noexcept { return (of(tree) + growth_ * strain) * strain; }

 private:
  double least() const noexcept;

  const TreeVersion& home_;
  double per_strain_;  // by how much a little strain raises it, over that strain
  double growth_ = 0;  // how much of this there is more for every unit of strain
};

}  // namespace morula::detail
