// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The trees of a rebuilt body, and which of them is to serve: docs/rebuild.md#how-a-tree-is-chosen.
#pragma once

#include <cstdint>
#include <memory>
#include <morula/update/rebuilt_body.hpp>
#include <optional>
#include <vector>

#include "update/rebuild/strain_cost.hpp"
#include "update/rebuild/tree_version.hpp"

namespace morula::detail {

/// Of lengths from one pose to another, where none has changed but by rounding.
inline constexpr double still_strain = 1e-5;

inline bool fits_leaves(const RebuildOptions& options) {
  return options.effort == RebuildEffort::high;
}

/// One at rest, one for each known pose, and one rebuilt for another pose. Exactly one of them serves: the present one.
class TreeVersions {
 public:
  /// Made at rest and at the known poses, which are of this mesh; the one at rest serves. min_improvement and effort:
  /// of `options`. estimator: of the mesh.
  TreeVersions(const MeshView& mesh, const CoveredTree& model, const RebuildOptions& options, LoosenessEstimator& estimator,
               Workers& workers);
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
  /// The tree whose own pose this is; else the present one, as where positions are not finite, or where lengths
  /// feel no difference: then rounding would choose.
  TreeVersion& made_for_this() noexcept;
  /// The present tree, updated in this frame, or one of some others that were updated beside it and take up less.
  TreeVersion& tightest_seen(std::uint64_t frame, const PositionView& positions, Workers& workers) noexcept;
  /// Others updated so far, to see whether they take up less.
  std::size_t candidates_evaluated() const noexcept { return candidates_evaluated_; }
  /// Is a rebuilt one, not looked at yet, expected to be better than all that there are?
  bool takes_over(TreeVersion& rebuilt, const PositionView& positions) const noexcept;
  /// Is it expected to be less than so many times as loose as where it was made? takes_over was asked in this frame.
  bool fits_here(const TreeVersion& rebuilt, double rebuild_threshold) const noexcept;

  // What became of it.

  void activate(TreeVersion& next) noexcept;
  /// Kept in the place of the one rebuilt before, which is handed out.
  void keep(std::unique_ptr<TreeVersion>& rebuilt) noexcept { away_.swap(rebuilt); }
  /// The present one was estimated to be so loose where its strain was this.
  void learn(const std::vector<double>& looseness, double strain) noexcept;

 private:
  double expected_score(const TreeVersion& tree) const noexcept;
  double promise_needed() const noexcept;
  std::size_t seen_in_a_frame() const noexcept;
  TreeVersion* next_to_see(std::uint64_t frame, bool has_grown) noexcept;
  template <typename Visit>
  void for_others(const Visit& visit) noexcept;

  double min_improvement_;
  TreeVersion home_;
  std::optional<StrainCost> cost_;  // once it is known how loose the home tree is
  std::vector<TreeVersion> known_;
  std::unique_ptr<TreeVersion> away_;  // rebuilt
  TreeVersion* present_;
  std::size_t tests_of_update_ = 0;  // points that the last one of the present tree tested
  std::size_t candidates_evaluated_ = 0;
  // Of the present one, at its last estimate.
  double strain_at_estimate_ = 0, score_at_estimate_ = 0;
};

}  // namespace morula::detail
