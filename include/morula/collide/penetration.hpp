// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Penetration volume: the volume that two solid bodies share, between two bounds.
#pragma once

#include <memory>
#include <morula/collide/budget.hpp>
#include <morula/collide/containment.hpp>
#include <vector>

namespace morula {

struct PenetrationOptions {
  /// Largest gap of the bounds of a finished result, relative to the upper bound. Finite, not negative.
  double tolerance = 0.25;
  /// Largest absolute gap of the bounds of a finished result, mesh units³; either tolerance suffices.
  double volume_tolerance = 0;
  /// Limit in tests: each test computes the distance of a point to a body. Half a gap takes four times as many.
  Budget budget{20000};
  Clock clock{};  ///< clock of a budget of time
};

struct [[nodiscard]] Penetration {
  Status status;
  double lower = 0, upper = 0;  ///< bounds of the volume, mesh units³
  double estimate = 0;  ///< estimate between the bounds, mesh units³; it treats surfaces as planes in undecided cells
  Vec3 center{};        ///< centroid of the estimated volume; (0, 0, 0) if the volume is 0
  /// True if a tolerance was reached; false if the budget ended first. The bounds hold in both cases.
  bool finished = false;
  bool certified = false;  ///< SphereState::covers of both bodies; if false, the bounds are not proven
  std::size_t probes = 0;  ///< probes of this call
};

/// Penetration query: repeated queries with kept memory. For one thread at a time.
///
/// Around a point inside a body lies an inner ball, whose radius is the distance to the surface; around a point outside
/// lies an empty ball. A cell of space within inner balls of both bodies counts fully for the lower bound; a cell
/// within an empty ball of either body counts for neither bound. All other cells are estimated by the balls about their
/// centers and divided into eight, the largest cell first. So both bounds hold at every interruption, and more work
/// only narrows them. Bodies may deform and move; inside is defined by InsideQuery.
class PenetrationQuery {
 public:
  /// Shares the state of both colliders. Throws std::invalid_argument for an open surface, like InsideQuery. Cost: O(F
  /// log F), once.
  PenetrationQuery(const Collider& a, const Collider& b);
  ~PenetrationQuery();
  PenetrationQuery(PenetrationQuery&&) noexcept;
  PenetrationQuery& operator=(PenetrationQuery&&) noexcept;

  /// Starts from the beginning. Rejects a tolerance or a budget out of range with bad_option, and bodies like
  /// InsideQuery.
  Penetration run(const PenetrationOptions& options = {});
  /// Narrows the present bounds with a new budget. Unless it is zero, a call divides one cell at any cost, up to 16
  /// tests. Rejected with no_front if no run was started, with other_frame or other_transform if a body has moved
  /// since, and with other_bodies if another one was assigned to its collider.
  Penetration resume(const PenetrationOptions& options = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace morula
