// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/strain_cost.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "update/rebuild/relative_looseness.hpp"

namespace morula::detail {
namespace {

// Increase of a tree's score by a unit of strain, per level that counts: the default until one is measured, and the
// least. Limbs at a strain of 0.03 are 1.7 times as loose in their leaves.
constexpr double usual_cost = 10, least_cost = 2;

double for_levels(const TreeVersion& home, double per_level) {
  const std::size_t levels = home.looseness_at_build.size();
  return per_level * static_cast<double>(levels - first_counted_level(levels));
}

double middle(std::vector<double>& figures) {
  const auto at = figures.begin() + static_cast<std::ptrdiff_t>(figures.size() / 2);
  std::nth_element(figures.begin(), at, figures.end());
  return *at;
}

}  // namespace

StrainCost::StrainCost(const TreeVersion& home) : home_(home), per_strain_(for_levels(home, usual_cost)) {}

double StrainCost::least() const noexcept {
  return for_levels(home_, least_cost);
}

// From the tree's own measurement elsewhere, else from the average cost of strain.
double StrainCost::of(const TreeVersion& tree) const noexcept {
  if (!(tree.strain_elsewhere > least_strain)) return per_strain_;
  return std::max(least(), of(tree, tree.looseness_elsewhere, tree.strain_elsewhere));
}

double StrainCost::of(const TreeVersion& tree, std::span<const double> looseness, double strain) const noexcept {
  return (relative_looseness(looseness, home_.looseness_at_build) -
          relative_looseness(tree.looseness_at_build, home_.looseness_at_build)) /
             strain -
         growth_ * strain;
}

// Looseness grows faster than strain does, and trees are chosen where strain is small: poses far apart alone would
// overestimate its cost there, and so reject trees that are rebuilt for a pose ahead. So the cost of a little strain
// comes from every tree's looseness at the pose nearest to its own, and its growth from the home tree's looseness at
// all known poses. The home tree, which serves first, goes by its own figure until it is measured.
void StrainCost::calibrate(TreeVersion& home, std::span<const TreeVersion> known, std::span<const PositionView> poses,
                           LoosenessEstimator& estimator, Workers& workers) {
  const auto tree = [&](std::size_t pose) -> const TreeVersion& { return pose == 0 ? home : known[pose - 1]; };
  const auto strain_at = [&](const TreeVersion& of, std::size_t pose) { return of.gauge.strain(poses[pose]); };
  std::vector<double> estimated(home.looseness_at_build.size());
  const auto is_estimated_at = [&](Body& probe, std::size_t pose) {
    if (!probe.update(poses[pose], workers)) return false;
    estimator.pose(poses[pose]);
    estimator.estimate(probe, estimated);
    return true;
  };
  std::vector<double> costs;
  for (std::size_t own = 0; own < poses.size(); ++own) {
    const TreeVersion& made = tree(own);
    std::optional<std::size_t> nearest;
    for (std::size_t pose = 0; pose < poses.size(); ++pose)
      if (const double strain = strain_at(made, pose);
          strain > least_strain && (!nearest || strain < strain_at(made, *nearest)))
        nearest = pose;
    Body probe(made.body);
    if (!nearest || !is_estimated_at(probe, *nearest)) continue;
    const double strain = strain_at(made, *nearest);
    if (own == 0) home.looseness_elsewhere = estimated, home.strain_elsewhere = strain;
    costs.push_back(of(made, estimated, strain));
  }
  if (costs.empty()) return;
  per_strain_ = std::max(least(), middle(costs));
  costs.clear();
  Body probe(home.body);
  for (std::size_t pose = 1; pose < poses.size(); ++pose)
    if (const double strain = strain_at(home, pose); strain > least_strain && is_estimated_at(probe, pose))
      costs.push_back((of(home, estimated, strain) - per_strain_) / strain);
  if (!costs.empty()) growth_ = std::max(0.0, middle(costs));
}

}  // namespace morula::detail
