// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Strain cost: the increase of a tree's relative looseness that is expected of strain.
#pragma once

#include <morula/geometry/positions.hpp>
#include <morula/parallel/workers.hpp>
#include <morula/update/looseness_estimate.hpp>
#include <span>

#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Below this, strain does not predict its cost.
inline constexpr double least_strain = 0.02;

class StrainCost {
 public:
  /// Starts with a typical cost, until one is measured. home: borrowed.
  explicit StrainCost(const TreeVersion& home);

  /// Computes the cost from the trees' looseness at each other's poses; poses[0] is rest, poses[k + 1] that of
  /// known[k].
  void calibrate(TreeVersion& home, std::span<const TreeVersion> known, std::span<const PositionView> poses,
                 LoosenessEstimator& estimator, Workers& workers);
  /// Takes the cost from the last measurement of this tree, at its strain_elsewhere.
  void learn_from(const TreeVersion& tree) noexcept { per_strain_ = of(tree); }

  /// Cost of a little strain, divided by that strain.
  double of(const TreeVersion& tree) const noexcept;
  /// The same, for a tree that is as loose as `looseness` at `strain` from the pose that it was built for.
  double of(const TreeVersion& tree, std::span<const double> looseness, double strain) const noexcept;
  /// Increase of the tree's relative looseness at this strain.
  double at(const TreeVersion& tree, double strain) const noexcept { return (of(tree) + growth_ * strain) * strain; }

 private:
  double least() const noexcept;

  const TreeVersion& home_;
  double per_strain_;  // increase by a little strain, divided by that strain
  double growth_ = 0;  // increase of per_strain_ per unit of strain
};

}  // namespace morula::detail
