// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The ownerships of a rebuilt body, and which of them is to serve: docs/known_poses.md#how-an-ownership-is-chosen.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "update/rebuild/epoch.hpp"
#include "update/rebuild/strain_cost.hpp"
#include "update/reowned_body.hpp"

namespace morula::detail {

/// Of lengths from one pose to another, where none has changed but by rounding.
inline constexpr double still_strain = 1e-5;

/// One at rest, one for each known pose, and one rebuilt for another pose. Exactly one of them serves: the present one.
class Ownerships {
 public:
  struct Settings {
    double gain;  ///< a rebuilt one has to be expected to be better by this share
    std::size_t reown_tests;
    ReownedBody::Ways ways;
  };
  /// Made at rest and at the known poses, which are of this mesh; the one at rest serves. estimator: of the mesh.
  Ownerships(const Mesh& mesh, const CoveredTree& built, const Settings& settings, LoosenessEstimator& estimator,
             Workers& workers);
  Ownerships(const Ownerships&) = delete;
  Ownerships& operator=(const Ownerships&) = delete;

  Epoch& home() noexcept { return home_; }
  Epoch& present() const noexcept { return *present_; }
  bool home_serves() const noexcept { return present_ == &home_; }
  bool is_known(const Epoch& ownership) const noexcept;
  std::size_t level_count() const { return home_.looseness_at_build.size(); }

  // A frame, from its positions on.

  /// How far they are from the poses that the ownerships were made for.
  void measure(const PositionView& positions) noexcept;
  /// From the pose that the present ownership was made for.
  double strain() const noexcept { return present_->strain_now; }
  /// Updates one; as it was made, where it has not served before this frame, and at rest.
  UpdateStatus follow(Epoch& ownership, bool resting, const PositionView& positions, Workers& workers) noexcept;
  /// The ownership whose own pose this is; else the present one, as where positions are not finite, or where lengths
  /// feel no difference: then rounding would choose.
  Epoch& made_for_this() noexcept;
  /// The present ownership, updated in this frame, or one of some others that were updated beside it and take up less.
  Epoch& tightest_seen(std::uint64_t frame, const PositionView& positions, Workers& workers) noexcept;
  /// Others looked at so far.
  std::size_t compared() const noexcept { return compared_; }
  /// Is a rebuilt one, not looked at yet, expected to be better than all that there are?
  bool takes_over(Epoch& rebuilt, const PositionView& positions) const noexcept;
  /// Is it expected to be less than so many times as loose as where it was made? takes_over was asked in this frame.
  bool fits_here(const Epoch& rebuilt, double looser_by) const noexcept;

  // What became of it.

  void serve(Epoch& next) noexcept;
  /// Kept in the place of the one rebuilt before, which is handed out.
  void keep(std::unique_ptr<Epoch>& rebuilt) noexcept { away_.swap(rebuilt); }
  /// The present one was estimated to be so loose where its strain was this.
  void learn(const std::vector<double>& looseness, double strain) noexcept;

 private:
  double expected_score(const Epoch& ownership) const noexcept;
  double promise_needed() const noexcept;
  std::size_t seen_in_a_frame() const noexcept;
  Epoch* next_to_see(std::uint64_t frame, bool has_grown) noexcept;
  template <typename Visit>
  void for_others(const Visit& visit) noexcept;

  Settings settings_;
  Epoch home_;
  std::optional<StrainCost> cost_;  // once it is known how loose the home ownership is
  std::vector<Epoch> known_;
  std::unique_ptr<Epoch> away_;  // rebuilt
  Epoch* present_;
  std::size_t tests_of_update_ = 0;  // points that the last one of the present ownership tested
  std::size_t compared_ = 0;
  // Of the present one, at its last estimate.
  double strain_at_estimate_ = 0, score_at_estimate_ = 0;
};

}  // namespace morula::detail
