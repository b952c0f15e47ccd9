// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/tree_versions.hpp"

#include <algorithm>
#include <limits>

#include "update/fitted_body.hpp"
#include "update/rebuild/relative_looseness.hpp"

namespace morula::detail {
namespace {

// Another tree costs a switch, after which queries start from scratch: its expected score has to be better by
// least_gain, and its volume less by least_less, which is a fifth of the looseness of tight leaves.
constexpr double least_gain = 0.02, least_less = 0.008;
// If the volume of a tree's spheres exceeds that at its build by this factor, other trees are evaluated in each frame,
// whatever their expected score.
constexpr double much_growth = 1.15;
// Other trees evaluated in one frame: one, or as many as test so many points together, about 8 us, but no more than
// eight.
// mutant known-seen-one-of-small-bodies: `8` -> `1`
// mutant known-seen-two-of-large-bodies: `1` -> `2`
constexpr std::size_t least_seen = 1, most_seen = 8, tests_to_see = 20'000;
// A tree that was evaluated as no better is evaluated again after all others and so many frames, or when the strain
// exceeds that at its evaluation by this factor.
constexpr std::size_t evaluated_lately = 4;
// mutant known-came-closer: `0.8` -> `0`
constexpr double closer = 0.8;

std::shared_ptr<const CoveredTree> without_poses(const CoveredTree& model) {
  return std::make_shared<const CoveredTree>(CoveredTree{model.tree, model.cover, model.report});
}

}  // namespace

TreeVersions::TreeVersions(const MeshView& mesh, const CoveredTree& model, const RebuildOptions& options,
                           LoosenessEstimator& estimator, Workers& workers)
    : min_improvement_(options.min_improvement),
      // Body checks whether mesh and tree belong together, so it comes first.
      home_(FittedBody::make(mesh, without_poses(model), fits_leaves(options), workers), mesh, estimator,
            model.tree.level_count()),
      present_(&home_) {
  std::vector<PositionView> poses{mesh.positions};
  for (const KnownPose& pose : model.poses) {
    poses.emplace_back(pose.positions);
    const MeshView posed(pose.positions, mesh.facets);
    known_.emplace_back(FittedBody::make(posed, pose.model, fits_leaves(options), workers), posed, estimator,
                        level_count());
  }
  cost_.emplace(home_).calibrate(home_, known_, poses, estimator, workers);
  activate(home_);
}

bool TreeVersions::is_known(const TreeVersion& tree) const noexcept {
  return std::any_of(known_.begin(), known_.end(), [&](const TreeVersion& k) { return &k == &tree; });
}

template <typename Visit>
void TreeVersions::for_others(const Visit& visit) noexcept {
  const auto unless_present = [&](TreeVersion& tree) {
    if (&tree != present_) visit(tree);
  };
  unless_present(home_);
  for (TreeVersion& tree : known_) unless_present(tree);
  if (rebuilt_) unless_present(*rebuilt_);
}

void TreeVersions::measure(const PositionView& positions) noexcept {
  present_->strain_now = present_->gauge.strain(positions);
  // mutant known-own-lengths: `other.gauge.strain` -> `home_.gauge.strain`
  for_others([&](TreeVersion& other) { other.strain_now = other.gauge.strain(positions); });
}

UpdateStatus TreeVersions::follow(TreeVersion& tree, const PositionView& positions, Workers& workers) noexcept {
  const UpdateStatus status = tree.body.update(positions, workers);
  if (status && &tree == present_) tests_of_update_ = status.points_tested;
  return status;
}

// Expected score of the present tree: its last measured score, and the strain added since.
double TreeVersions::expected_score(const TreeVersion& tree) const noexcept {
  const double strain = tree.strain_now;
  const auto more = [&](double at) { return cost_->at(tree, at); };
  if (&tree == present_) return score_at_estimate_ + more(strain) - more(strain_at_estimate_);
  return relative_looseness(tree.looseness_at_build, home_.looseness_at_build) + more(strain);
}

// The score that another tree has to be expected to stay below.
double TreeVersions::score_to_beat() const noexcept {
  return (1 - std::max(least_gain, min_improvement_)) * expected_score(*present_);
}

TreeVersion& TreeVersions::tree_for_this_pose() noexcept {
  TreeVersion* own = present_;
  double least = strain();
  if (least < still_strain) return *present_;
  for_others([&](TreeVersion& other) {
    const double its = other.strain_now;
    if (its < still_strain && its < least) least = its, own = &other;
  });
  return *own;
}

// The cost of strain is an estimate: if components of a body come apart, few lengths measure that. The volume of
// spheres is measured, so it decides.
TreeVersion& TreeVersions::tightest_evaluated(std::uint64_t frame, const PositionView& positions,
                                              Workers& workers) noexcept {
  const bool has_grown = present_->growth() > much_growth;
  TreeVersion* best = present_;
  // mutant known-seen-decides: `(1 - least_less)` -> `0.9`
  double least = (1 - least_less) * present_->taken_up();
  const std::size_t count = evaluated_in_a_frame();
  for (std::size_t seen = 0; seen < count; ++seen) {
    TreeVersion* const other = next_to_evaluate(frame, has_grown);
    if (other == nullptr || !follow(*other, positions, workers)) break;
    ++candidates_evaluated_;
    other->seen_frame = frame, other->seen_strain = other->strain_now;
    if (const double its = other->taken_up(); its < least) least = its, best = other;
  }
  return *best;
}

std::size_t TreeVersions::evaluated_in_a_frame() const noexcept {
  return std::clamp(tests_to_see / std::max<std::size_t>(1, tests_of_update_), least_seen, most_seen);
}

// The tree with the best expected score of those not evaluated lately, so that each tree's turn comes. Only trees with
// a better expected score are candidates while the volume of the present one's spheres is about that at its build.
TreeVersion* TreeVersions::next_to_evaluate(std::uint64_t frame, bool has_grown) noexcept {
  // mutant known-in-turn: `std::max(evaluated_lately, known_.size() / evaluated_in_a_frame() + 1)` -> `evaluated_lately`
  const std::uint64_t round = std::max(evaluated_lately, known_.size() / evaluated_in_a_frame() + 1);
  TreeVersion* next = nullptr;
  double least = has_grown ? std::numeric_limits<double>::infinity() : score_to_beat();
  for_others([&](TreeVersion& other) {
    const bool seen_before = other.seen_frame != 0 && frame < other.seen_frame + round;
    if (other.seen_frame == frame || (seen_before && !(other.strain_now < closer * other.seen_strain))) return;
    if (const double score = expected_score(other); score < least) least = score, next = &other;
  });
  return next;
}

bool TreeVersions::takes_over(TreeVersion& rebuilt, const PositionView& positions) const noexcept {
  rebuilt.strain_now = rebuilt.gauge.strain(positions);
  double least = expected_score(*present_);
  for (const TreeVersion& tree : known_) least = std::min(least, expected_score(tree));
  return expected_score(rebuilt) < (1 - min_improvement_) * std::min(least, expected_score(home_));
}

bool TreeVersions::fits_here(const TreeVersion& rebuilt, double rebuild_threshold) const noexcept {
  const double at_build = relative_looseness(rebuilt.looseness_at_build, home_.looseness_at_build);
  return expected_score(rebuilt) <= rebuild_threshold * at_build;
}

void TreeVersions::activate(TreeVersion& next) noexcept {
  present_ = &next;
  score_at_estimate_ = relative_looseness(next.looseness_at_build, home_.looseness_at_build);
  strain_at_estimate_ = 0;
}

void TreeVersions::learn(const std::vector<double>& looseness, double strain) noexcept {
  score_at_estimate_ = relative_looseness(looseness, home_.looseness_at_build);
  strain_at_estimate_ = strain;
  if (!(strain > least_strain)) return;
  present_->looseness_elsewhere = looseness;
  present_->strain_elsewhere = strain;
  cost_->learn_from(*present_);
}

}  // namespace morula::detail
