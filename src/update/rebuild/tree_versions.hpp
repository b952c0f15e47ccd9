// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The trees of a rebuilt body, and which of them is to serve: docs/how-to/rebuild.md#how-a-tree-is-chosen.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <vector>

#include "update/rebuild/strain_cost.hpp"
#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Two poses count as equal where the strain between them is below this: smaller strain is rounding.
inline constexpr double still_strain = 1e-5;

inline bool fits_leaves(const RebuildOptions& options) {
  return options.effort == RebuildEffort::high;
}

/// One at rest, one for each known pose, and one rebuilt for another pose. Exactly one of them serves: the present one.
class TreeVersions {
 public:
  /// Made at rest and at the known poses, which are of this mesh; the one at rest serves. min_improvement and effort:
  /// of `options`. estimator: of the mesh.
  TreeVersions(const MeshView& mesh, const CoveredTree& model, const RebuildOptions& options,
               LoosenessEstimator& estimator, Workers& workers);
  TreeVersions(const TreeVersions&) = delete;
  TreeVersions& operator=(const TreeVersions&) = delete;

  TreeVersion& home() noexcept { return home_; }
  TreeVersion& present() const noexcept { return *present_; }
  bool home_serves() const noexcept { return present_ == &home_; }
  bool is_known(const TreeVersion& tree) const noexcept;
  std::size_t level_count() const { return home_.looseness_at_build.size(); }

  // A frame, from its positions on.

  /// How far they are from the poses that the trees were made for.
  void measure(const PositionView& positions) noexcept;
  /// From the pose that the present tree was made for.
  double strain() const noexcept { return present_->strain_now; }
  /// Updates one.
  UpdateStatus follow(TreeVersion& tree, const PositionView& positions, Workers& workers) noexcept;
  /// Returns the tree that was made for this pose. Returns the present tree where there is none, where the present one
  /// fits as well, and where positions are not finite.
  TreeVersion& tree_for_this_pose() noexcept;
  /// Updates some other trees and returns the tightest, or the present tree, which was updated in this frame.
  TreeVersion& tightest_evaluated(std::uint64_t frame, const PositionView& positions, Workers& workers) noexcept;
  /// Updates of other trees so far, made to find out whether they are tighter.
  std::size_t candidates_evaluated() const noexcept { return candidates_evaluated_; }
  /// Is a rebuilt one, not looked at yet, expected to be better than all that there are?
  bool takes_over(TreeVersion& rebuilt, const PositionView& positions) const noexcept;
  /// Does its expected looseness stay within rebuild_threshold times that at its build? Call takes_over() first.
  bool fits_here(const TreeVersion& rebuilt, double rebuild_threshold) const noexcept;

  // What became of it.

  void activate(TreeVersion& next) noexcept;
  /// Keeps the tree and gives back the one that was rebuilt before it.
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
  std::optional<StrainCost> cost_;  // once it is known how loose the home tree is
  std::vector<TreeVersion> known_;
  std::unique_ptr<TreeVersion> rebuilt_;
  TreeVersion* present_;
  std::size_t tests_of_update_ = 0;  // points that the last one of the present tree tested
  std::size_t candidates_evaluated_ = 0;
  // Of the present one, at its last estimate.
  double strain_at_estimate_ = 0, score_at_estimate_ = 0;
};

}  // namespace morula::detail
