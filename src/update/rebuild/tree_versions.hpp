// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The trees of a rebuilt body, and the choice of the one that serves:
// docs/explanation/update_cost.md#how-a-rebuilt-body-chooses-its-tree.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <vector>

#include "update/rebuild/strain_cost.hpp"
#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Two poses count as equal if the strain between them is below this: smaller strain is rounding.
inline constexpr double still_strain = 1e-5;

inline bool fits_leaves(const RebuildOptions& options) {
  return options.effort == RebuildEffort::high;
}

/// One tree at rest, one for each known pose, and one rebuilt for another pose. Exactly one of them serves: the present
/// one.
class TreeVersions {
 public:
  /// Makes trees at rest and at the known poses, which are of this mesh; the one at rest serves. min_improvement and
  /// effort: of `options`. estimator: of the mesh.
  TreeVersions(const MeshView& mesh, const CoveredTree& model, const RebuildOptions& options,
               LoosenessEstimator& estimator, Workers& workers);
  TreeVersions(const TreeVersions&) = delete;
  TreeVersions& operator=(const TreeVersions&) = delete;

  TreeVersion& home() noexcept { return home_; }
  TreeVersion& present() const noexcept { return *present_; }
  bool home_serves() const noexcept { return present_ == &home_; }
  bool is_known(const TreeVersion& tree) const noexcept;
  std::size_t level_count() const { return home_.looseness_at_build.size(); }

  // Steps of a frame, first of all measure().

  /// Measures the strain from the poses that the trees were made for to these positions.
  void measure(const PositionView& positions) noexcept;
  /// Strain from the pose that the present tree was made for.
  double strain() const noexcept { return present_->strain_now; }
  /// Updates one tree.
  UpdateStatus follow(TreeVersion& tree, const PositionView& positions, Workers& workers) noexcept;
  /// Returns the tree that was made for this pose. Returns the present tree if there is none, if the present one fits
  /// as well, or if positions are not finite.
  TreeVersion& tree_for_this_pose() noexcept;
  /// Updates some other trees and returns the tightest, or the present tree, which was updated in this frame.
  TreeVersion& tightest_evaluated(std::uint64_t frame, const PositionView& positions, Workers& workers) noexcept;
  /// Number of updates of other trees so far, made to compare their tightness.
  std::size_t candidates_evaluated() const noexcept { return candidates_evaluated_; }
  /// Whether a rebuilt tree that was not evaluated yet is expected to be better than all others.
  bool takes_over(TreeVersion& rebuilt, const PositionView& positions) const noexcept;
  /// Whether its expected looseness stays within rebuild_threshold times that at its build. Call takes_over() first.
  bool fits_here(const TreeVersion& rebuilt, double rebuild_threshold) const noexcept;

  // Results of a frame.

  void activate(TreeVersion& next) noexcept;
  /// Keeps the tree and swaps the last rebuilt one into `rebuilt`.
  void keep(std::unique_ptr<TreeVersion>& rebuilt) noexcept { rebuilt_.swap(rebuilt); }
  /// Records the looseness that was estimated for the present tree at this strain.
  void learn(const std::vector<double>& looseness, double strain) noexcept;

 private:
  double expected_score(const TreeVersion& tree) const noexcept;
  double score_to_beat() const noexcept;
  std::size_t evaluated_in_a_frame() const noexcept;
  TreeVersion* next_to_evaluate(std::uint64_t frame, bool has_grown) noexcept;
  template <typename Visit>
  void for_others(const Visit& visit) noexcept;

  double min_improvement_;
  TreeVersion home_;
  std::optional<StrainCost> cost_;  // cost, once the looseness of the home tree is measured
  std::vector<TreeVersion> known_;
  std::unique_ptr<TreeVersion> rebuilt_;
  TreeVersion* present_;
  std::size_t tests_of_update_ = 0;  // points that the last update of the present tree tested
  std::size_t candidates_evaluated_ = 0;
  // Strain and score of the present tree, at its last estimate.
  double strain_at_estimate_ = 0, score_at_estimate_ = 0;
};

}  // namespace morula::detail
