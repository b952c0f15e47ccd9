// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Child fit: the search for the children of one node, balls over points of its region, moved until they cover least
// empty space together.
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
    // Weight of empty space that siblings cover already, in a ball's cost: during splitting, and afterwards.
    float overlap_weight_while_splitting = 0.6F;
    float overlap_weight = 0.15F;
    float child_width = 1;        // width of a child's part of the surface, in cells
    float balance = 0;            // weight of unequal demand among children
    bool retries_splits = false;  // tries a rejected split again even if the ball has not changed
  };
  /// grid, points, shape: borrowed. max_balls: greatest number of balls. start: the node's own ball, mesh coordinates.
  ChildFit(OutsideGrid& grid, const GroupPoints& points, const ObjectShape& shape, std::size_t max_balls,
           const Sphere& start, const Settings& settings, std::uint64_t seed);

  /// Makes one ball over all points and splits balls until there are max_balls or splitting does not pay.
  void split_from_one();
  /// Starts from these balls; each point goes to the ball of least power. fill_places holds until the next call: if it
  /// is false, no sweep adds a ball.
  void start_from(std::span<const Sphere> balls, bool fill_places = true);
  /// Starts from balls in grid coordinates; whether sweeps add balls stays unchanged.
  void start_from_grid(std::span<const GroupBall> balls);
  /// Assigns each point to the ball of least power, fits each ball to its points, and places unused balls by splitting.
  /// exclusive: gives each point that a sibling contains to that sibling first.
  void sweep(float overlap_weight, bool exclusive);
  /// Assigns each point to the inscribed ball of least power instead: for balls that are stuck in a poor arrangement.
  void sweep_inscribed(float overlap_weight);
  /// Tries random changes and keeps those that lower the objective: every move_every-th relocates a ball, the others
  /// shift walls between balls.
  void try_changes(int count, int move_every);
  /// Runs the sweeps, those by inscribed power first, and keeps the result only if the objective falls.
  void try_inscribed(int inscribed_sweeps, int sweeps);
  void try_seeds(std::span<const GroupBall> seeds, int inscribed_sweeps, int sweeps);
  void try_spheres(std::span<const Sphere> balls, int sweeps);

  /// Empty space in the union of the balls, plus the balance term. Sets balance_scale_ if it is negative.
  double objective();
  /// Fits a ball to other points, while the child nearest to the first start is lifted out of the grid.
  GroupBall fit_to(const GroupPoints& points, std::span<const Vec3f> starts);
  std::vector<Sphere> spheres() const;

 private:
  /// Runs change(). Restores the earlier state if the objective has not fallen.
  template <class Change>
  void keep_if_better(const Change& change);
  std::vector<GroupBall> in_grid(std::span<const Sphere> balls) const;
  std::vector<float> squared_radii() const;
  void run_sweeps(int inscribed_sweeps, int sweeps);
  void fill(float overlap_weight);
  bool split_costliest(std::size_t into, float overlap_weight, std::vector<std::uint8_t>& rejected);
  float split_priority(std::size_t ball, std::span<const float> demand) const;
  std::size_t cheapest_to_remove(std::vector<float>& growth_if_removed);
  void relocate_sphere(std::vector<float>& growth_if_removed);
  void nudge();
  double imbalance();
  const PlacedBalls& balls() const { return state_.balls(); }
  bool is_used(std::size_t ball) const { return state_.assignment().is_used(ball); }
  std::size_t max_balls() const { return state_.max_balls(); }

  ChildState state_;
  WholeBalls better_whole_;
  const ObjectShape& shape_;
  Vec3f start_;
  Settings settings_;
  Random random_;
  // Unit cost of the balance term: a quarter of the first ball's cost during splitting, then the cost at the first
  // objective(); negative: not computed yet.
  double balance_scale_ = -1;
  bool fill_places_ = true;  // see start_from()
};

}  // namespace morula::detail
