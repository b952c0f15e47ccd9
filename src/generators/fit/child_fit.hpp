// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Child fit: the search for the children of one node, balls over points of its region, moved to where they take in
// least empty space together.
//
//   ChildFit       the search: splits, sweeps, random changes; keeps a state or restores the one before
//      |           draws random numbers, sums the objective
//      v
//   ChildState     one step: recenter a ball, split it, remove it, reassign points; snapshot and restore
//      |           keeps the three below in step
//      +--> PlacedBalls   the balls, counted in the OutsideGrid that fits go by
//      +--> Assignment    the ball that owns each point; count, hash and demand per ball
//      |       +--> PowerCells   the ball of least power at each point, updated for the balls that moved
//      +--> FitCache      the time of each ball's last change and fit: a recenter that would change nothing is skipped
//
//   WholeBalls     (of ChildFit) balls that proved better whole than split
//
// Each type states its invariant, and has one place where it changes; no cache is invalidated from outside.
#pragma once

#include <morula/geometry/reproducible.hpp>
#include <span>
#include <vector>

#include "generators/fit/child_state.hpp"
#include "generators/fit/object_shape.hpp"

namespace morula::detail {

class ChildFit {
 public:
  struct Settings {
    float overlap_weight_while_splitting = 0.6F;  // what space that siblings have counts, early and late
    float overlap_weight = 0.15F;
    float child_width = 1;        // of a child's part of the surface, in cells
    float balance = 0;            // weight of unequal demand among children
    bool retries_splits = false;  // also those that were rejected as all stands: the same balls, later
  };
  /// grid, points, shape: borrowed. most: balls wanted. start: the node's own ball, mesh coordinates.
  ChildFit(OutsideGrid& grid, const GroupPoints& points, const ObjectShape& shape, std::size_t most,
           const Sphere& start, const Settings& settings, std::uint64_t seed);

  /// One ball over all points, then split until there are as many as wanted or splitting does not pay.
  void split_from_one();
  /// Takes these balls: points go to the one of least power. fill_places: sweeps may place further balls.
  void take(std::span<const Sphere> balls, bool fill_places = true);
  void take_in_grid(std::span<const GroupBall> balls);
  /// Points to the ball of least power, balls fitted to their points, unused ones placed by splitting. exclusive: a
  /// ball keeps only points that no sibling contains.
  void sweep(float overlap_weight, bool exclusive);
  /// Points to the inscribed ball of least power: for balls that have settled where they are but not where they should.
  void sweep_inscribed(float overlap_weight);
  /// Random changes, kept when they help: every move_every-th moves a ball elsewhere, the others nudge walls.
  void try_changes(int count, int move_every);
  /// Settles on whichever is better: as it is, or after sweeps by inscribed power.
  void try_inscribed(int inscribed_sweeps, int sweeps);
  void try_seeds(std::span<const GroupBall> seeds, int inscribed_sweeps, int sweeps);
  void try_spheres(std::span<const Sphere> balls, int sweeps);

  /// Empty space that the balls take in together, and what balance adds.
  double objective();
  /// Fits a ball to other points, with all children but the nearest to the first start in place.
  GroupBall fit_to(const GroupPoints& points, std::span<const Vec3f> starts);
  std::vector<Sphere> spheres() const;

 private:
  /// Runs change(), and restores the state before where the objective is no less.
  template <class Change>
  void keep_if_better(const Change& change);
  std::vector<GroupBall> in_grid(std::span<const Sphere> balls) const;
  std::vector<float> squared_radii() const;
  void settle(int inscribed_sweeps, int sweeps);
  void fill(float overlap_weight);
  bool split_costliest(std::size_t into, float overlap_weight, std::vector<std::uint8_t>& rejected);
  float split_priority(std::size_t ball, std::span<const float> demand) const;
  std::size_t least_missed(std::vector<float>& missed);
  void relocate_sphere(std::vector<float>& missed);
  void nudge();
  double imbalance();
  const PlacedBalls& balls() const { return state_.balls(); }
  bool is_used(std::size_t ball) const { return state_.assignment().is_used(ball); }
  std::size_t most() const { return state_.most(); }

  ChildState state_;
  WholeBalls better_whole_;
  const ObjectShape& shape_;
  Vec3f start_;
  Settings settings_;
  Random random_;
  double scale_ = -1;  // of the balance term: the cost at the start; negative: not known yet
  bool fill_places_ = true;
};

}  // namespace morula::detail
