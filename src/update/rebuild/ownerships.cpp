// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "update/rebuild/ownerships.hpp"

#include <algorithm>
#include <limits>

#include "update/rebuild/relative_looseness.hpp"

namespace morula::detail {
namespace {

// An ownership costs a switch, which makes queries start anew: it has to be expected to be better by this much.
constexpr double least_gain = 0.02;
// Where the spheres of an ownership take up so many times what they did where it was made, another is looked at in each
// frame, whatever is expected of it.
constexpr double grown = 1.15;
// What spheres take up is clearly more, or clearly less, above and below these shares.
constexpr double much_more = 1.15, much_less = 0.85;
// Others looked at in one frame.
constexpr int most_seen = 2;
// An ownership that was seen to be no better is looked at again after so many frames: meanwhile others are.
constexpr std::uint64_t seen_lately = 4;
// Every so many frames it is the turn of the one not seen for longest, so that none is left aside for ever.
constexpr std::uint64_t turn_every = 3;

std::shared_ptr<const CoveredTree> without_poses(const CoveredTree& built) {
  return std::make_shared<const CoveredTree>(CoveredTree{built.tree, built.cover, built.report});
}

}  // namespace

Ownerships::Ownerships(const Mesh& mesh, const CoveredTree& built, const Settings& settings,
                       LoosenessEstimator& estimator, Workers& workers)
    : settings_(settings),
      // Whether they belong together is what Body asks, so it comes first.
      home_{ReownedBody::make(mesh, without_poses(built), workers, settings.ways),
            std::vector<double>(built.tree.level_count()),
            {},
            {}},
      gauge_(std::make_shared<const StrainGauge>(mesh, built)),
      volumes_(home_.body),
      present_(&home_),
      lengths_(gauge_->length_count()) {
  home_ = made(mesh, std::move(home_.body), estimator);
  std::vector<PositionView> poses{mesh.positions};
  for (const KnownPose& pose : built.poses) {
    poses.emplace_back(pose.positions);
    const Mesh posed{pose.positions, mesh.facets};
    known_.push_back(made(posed, ReownedBody::make(posed, pose.built, workers, settings.ways), estimator));
  }
  cost_.emplace(home_).calibrate(home_, known_, poses, estimator, workers);
  serve(home_);
}

// The body is at the pose that it was made for.
Epoch Ownerships::made(const Mesh& posed, Body body, LoosenessEstimator& estimator) const {
  Epoch result{std::move(body), std::vector<double>(level_count()), std::vector<float>(gauge_->length_count()),
               std::vector<double>(level_count())};
  estimator.reserve(result.body.rest_tree().node_count());
  estimator.pose(posed.positions);
  estimator.estimate(result.body, result.looseness_at_build);
  gauge_->measure(posed.positions, result.lengths);
  result.volume_at_build = volumes_.of(result.body);
  return result;
}

bool Ownerships::is_known(const Epoch& ownership) const noexcept {
  return std::any_of(known_.begin(), known_.end(), [&](const Epoch& k) { return &k == &ownership; });
}

UpdateStatus Ownerships::follow(Epoch& ownership, bool resting, const PositionView& positions,
                                Workers& workers) noexcept {
  const bool as_made = resting || &ownership != present_;
  if (as_made) ReownedBody::give_back(ownership.body);
  return ReownedBody::update(ownership.body, positions, as_made ? 0 : settings_.reown_tests, workers);
}

// Of the present one: what was measured last, and what strain has been added since.
double Ownerships::expected_score(const Epoch& ownership) const noexcept {
  const double strain = StrainGauge::strain(lengths_, ownership.lengths);
  const auto more = [&](double at) { return cost_->at(ownership, at); };
  if (&ownership == present_) return score_at_estimate_ + more(strain) - more(strain_at_estimate_);
  return relative_looseness(ownership.looseness_at_build, home_.looseness_at_build) + more(strain);
}

// What another has to be expected to stay below.
double Ownerships::promise_needed() const noexcept {
  return (1 - std::max(least_gain, settings_.gain)) * expected_score(*present_);
}

template <typename Visit>
void Ownerships::for_others(const Visit& visit) noexcept {
  const auto unless_present = [&](Epoch& ownership) {
    if (&ownership != present_) visit(ownership);
  };
  unless_present(home_);
  for (Epoch& ownership : known_) unless_present(ownership);
  if (away_) unless_present(*away_);
}

Epoch& Ownerships::made_for_this() noexcept {
  Epoch* own = present_;
  double least = strain();
  if (least < still_strain) return *present_;
  for_others([&](Epoch& other) {
    const double its = StrainGauge::strain(lengths_, other.lengths);
    if (its < still_strain && its < least) least = its, own = &other;
  });
  return *own;
}

// Another serves that is expected to be tighter and does not take up much more, or that takes up much less. What strain
// costs is a guess: where a body has parts that come apart, lengths feel few of them. What spheres take up counts many
// times what they share.
Epoch& Ownerships::tightest_seen(std::uint64_t frame, const PositionView& positions, Workers& workers) noexcept {
  const double taken_up = volumes_.of(present_->body);
  const bool has_grown = taken_up > grown * present_->volume_at_build;
  Epoch* best = present_;
  double least = std::numeric_limits<double>::infinity();  // that another takes up which may serve
  for (int seen = 0; seen < most_seen; ++seen) {
    Epoch* const other = next_to_see(frame, has_grown);
    if (other == nullptr || !follow(*other, false, positions, workers)) break;
    other->seen_frame = frame;
    const double most = expected_score(*other) < promise_needed() ? much_more : much_less;
    const double its = volumes_.of(other->body);
    if (its < most * taken_up && its < least) least = its, best = other;
  }
  return *best;
}

// The one that is expected to be the tightest of those not seen lately, and now and then the one not seen for longest.
// As long as the present one takes up what it did where it was made, only what promises to be better.
Epoch* Ownerships::next_to_see(std::uint64_t frame, bool has_grown) noexcept {
  Epoch* next = nullptr;
  double least = has_grown ? std::numeric_limits<double>::infinity() : promise_needed();
  const bool in_turn = has_grown && frame % turn_every == 0;
  for_others([&](Epoch& other) {
    if (other.seen_frame == frame) return;
    if (!in_turn && other.seen_frame != 0 && frame < other.seen_frame + seen_lately) return;
    const double score = in_turn ? static_cast<double>(other.seen_frame) : expected_score(other);
    if (score < least) least = score, next = &other;
  });
  return next;
}

bool Ownerships::takes_over(const Epoch& rebuilt) const noexcept {
  double least = expected_score(*present_);
  for (const Epoch& ownership : known_) least = std::min(least, expected_score(ownership));
  return expected_score(rebuilt) < (1 - settings_.gain) * std::min(least, expected_score(home_));
}

bool Ownerships::fits_here(const Epoch& rebuilt, double looser_by) const noexcept {
  const double at_build = relative_looseness(rebuilt.looseness_at_build, home_.looseness_at_build);
  return expected_score(rebuilt) <= looser_by * at_build;
}

void Ownerships::serve(Epoch& next) noexcept {
  present_ = &next;
  score_at_estimate_ = relative_looseness(next.looseness_at_build, home_.looseness_at_build);
  strain_at_estimate_ = 0;
}

void Ownerships::learn(const std::vector<double>& looseness, double strain) noexcept {
  score_at_estimate_ = relative_looseness(looseness, home_.looseness_at_build);
  strain_at_estimate_ = strain;
  if (!(strain > least_strain)) return;
  // What patches that changed hands have brought is not what the ownership would be like as it was made: that is
  // looser.
  if (present_->body.pose().dealing != 0 && cost_->of(*present_, looseness, strain) <= cost_->of(*present_)) return;
  present_->looseness_elsewhere = looseness;
  present_->strain_elsewhere = strain;
  cost_->learn_from(*present_);
}

}  // namespace morula::detail
