// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Penetration volume: how much space two solid bodies share, between two bounds.
#pragma once

#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/containment.hpp>
#include <vector>

namespace morula {

struct PenetrationOptions {
  /// Ends when the bounds are so near each other, as a share of the upper one. Finite, not negative.
  double tolerance = 0.25;
  /// Or this near, mesh units cubed.
  double volume_tolerance = 0;
  /// In tests: points at which a body is asked for its distance. Half a gap takes four times as many.
  Budget budget{20000};
  Clock clock{};  ///< of a budget of time
};

struct [[nodiscard]] Penetration {
  Status status;
  double lower = 0, upper = 0;  ///< the volume is between them
  double estimate = 0;          ///< between them, too: as if surfaces were planes where it is undecided
  Vec3 center{};                ///< of the estimated volume; where there is none (0, 0, 0)
  /// The tolerance was reached; else the budget ended before, and the bounds are as they are.
  bool finished = false;
  bool certified = false;  ///< SphereState::covers of both; else the bounds are no proofs
  std::size_t probes = 0;  ///< done by this call
};

/// Penetration query: asks again and again, and keeps its memory. For one thread at a time.
///
/// Around a point inside a body, as far away as the surface is, lies a ball that is inside: an inner ball. Around one
/// outside lies an empty one. A cell of space that is within inner balls of both bodies counts for the lower bound, one
/// that is within an empty ball of either for nothing; all others count by the balls about their middles, and are
/// divided into eight, the largest first. So both bounds hold at every interruption, and more work only narrows them.
/// Bodies deform and are placed as always; inside is what InsideQuery says.
class PenetrationQuery {
 public:
  /// Borrows both. Throws std::invalid_argument for an open surface, as InsideQuery does. Cost: O(F log F), once.
  PenetrationQuery(const Collider& a, const Collider& b);
  ~PenetrationQuery();
  PenetrationQuery(PenetrationQuery&&) noexcept;
  PenetrationQuery& operator=(PenetrationQuery&&) noexcept;

  /// From the beginning. The status says what was refused: bad_option for a tolerance or a budget out of range, what a
  /// body lacks as InsideQuery does.
  Penetration run(const PenetrationOptions& options = {});
  /// Narrows what is there, with a new budget. Refused with no_front when nothing was started, and with other_frame or
  /// other_transform when a body has moved since.
  Penetration resume(const PenetrationOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
