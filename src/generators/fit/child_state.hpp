// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Child state: the balls of a node's children, the points that each owns, and the cached state of their fits. A ball
// contains its points after recenter(); after assign_by_power() or remove() it may not, until the next one.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_set>
#include <vector>

#include "generators/fit/assignment.hpp"
#include "generators/fit/ball_fit.hpp"

namespace morula::detail {

/// Inputs that a fit depends on, besides siblings near by.
struct FitInputs {
  std::uint64_t points_hash;
  float overlap_weight;
  bool operator==(const FitInputs&) const = default;
};

/// Invariant: has_fit(b) is true only if a fit to these inputs made ball b, and no sibling near it has changed since,
/// as far as each sibling's last change shows. (A ball that is relocated changes twice, and its departure is forgotten:
/// its old neighbors keep their fits, which contain their points all the same.) Every change of a ball goes through
/// note_fit() or note_change(); only these two make an entry stale, by its time.
class FitCache {
 public:
  explicit FitCache(std::size_t most) : entries_(most) {}

  bool has_fit(std::size_t ball, const FitInputs& inputs, std::span<const GroupBall> balls) const;
  /// Records that the ball was `before` and is the fit `after`.
  void note_fit(std::size_t ball, const GroupBall& before, const GroupBall& after, const FitInputs& inputs);
  /// Records that the ball was `before` and has changed, by another step than a fit.
  void note_change(std::size_t ball, const GroupBall& before);

 private:
  struct Entry {
    std::uint64_t changed = 0, fitted = 0;  // times; 0: never
    FitInputs inputs{0, -1};
    GroupBall before{};  // the ball before its last change
  };
  std::vector<Entry> entries_;
  std::uint64_t clock_ = 0;
};

/// Balls that proved better whole than split, with their points and cost. When siblings move, the cost changes: then
/// the same ball is a new entry, and no entry ever needs to be invalidated.
class WholeBalls {
 public:
  static std::uint64_t key(const GroupBall& b, const FitInputs& inputs);
  bool contains(std::uint64_t key) const { return keys_.contains(key); }
  void insert(std::uint64_t key) { keys_.insert(key); }

 private:
  std::unordered_set<std::uint64_t> keys_;
};

/// Balls, and the grid that counts the space they cover. Invariant: the grid counts every ball with a radius, except
/// lifted ones. A fit lifts its ball first: the grid must not count the ball that is sought.
class PlacedBalls {
 public:
  /// grid: borrowed; counts none of them yet.
  PlacedBalls(OutsideGrid& grid, std::size_t most) : grid_(grid), balls_(most), is_placed_(most, 0) {}

  OutsideGrid& grid() const { return grid_; }
  std::size_t size() const { return balls_.size(); }
  const GroupBall& operator[](std::size_t i) const { return balls_[i]; }
  operator std::span<const GroupBall>() const { return balls_; }

  void lift(std::size_t i);
  /// Lifts the ball, unless it is lifted already, and places the other.
  void place(std::size_t i, const GroupBall& ball);

 private:
  OutsideGrid& grid_;
  std::vector<GroupBall> balls_;
  std::vector<std::uint8_t> is_placed_;
};

/// Operations on one child, or on the owners of points. Each keeps balls, assignment and fits in step; searches are
/// made of them.
class ChildState {
 public:
  struct Snapshot {
    std::vector<GroupBall> balls;
    std::vector<std::uint8_t> owners;
    FitCache fits;
  };

  /// grid, points: borrowed. max_balls: 256 at most.
  ChildState(OutsideGrid& grid, const GroupPoints& points, std::size_t max_balls)
      : balls_(grid, max_balls), assignment_(points, max_balls), fits_(max_balls) {}

  std::size_t max_balls() const { return balls_.size(); }
  OutsideGrid& grid() const { return balls_.grid(); }
  const PlacedBalls& balls() const { return balls_; }
  const Assignment& assignment() const { return assignment_; }
  std::span<const float> demand() { return assignment_.demand(); }
  FitInputs fit_inputs(std::size_t ball, float overlap_weight) const {
    return {assignment_.hash(ball), overlap_weight};
  }

  Snapshot snapshot() const;
  void restore(const Snapshot& snapshot);

  /// Replaces the balls, by max_balls() at most, none of them fitted. Points keep their owners.
  void set_balls(std::span<const GroupBall> balls);
  /// Assigns all points to ball 0.
  void give_all_to_first() { assignment_.set_all(0); }
  /// Assigns each point to the ball of least power. A ball whose squared radius is negative gets none.
  void assign_by_power(std::span<const float> squared_radii) { assignment_.set_by_power(balls_, squared_radii); }
  /// Reassigns each of the ball's points that a sibling contains to that sibling.
  void give_what_others_contain(std::size_t ball);

  /// Fits the ball to its points. Skips a ball that is fitted already. first_step: see fit_ball. A ball without points
  /// vanishes.
  void recenter(std::size_t ball, float overlap_weight, float first_step);
  /// A ball for other points, while the ball nearest to the first start is lifted. Changes nothing.
  GroupBall fit_to(const GroupPoints& points, std::span<const Vec3f> starts, float overlap_weight);
  /// Splits the ball's points in two along one of their principal axes and fits a ball to each part; `into`, an unused
  /// ball, gets the second. Returns false and changes nothing if the two together cost at least max_cost_factor times
  /// the cost of the one.
  bool split(std::size_t ball, std::size_t into, float overlap_weight, float max_cost_factor);
  /// Removes the ball and gives each of its points to the sibling that grows least by it. Siblings do not contain these
  /// points until recenter(). The points stay if no sibling is in use.
  void remove(std::size_t ball);
  /// Growth in volume of the siblings if the ball were removed.
  float growth_without(std::size_t ball) const;

 private:
  struct Halves {
    GroupBall one, other;
    std::vector<std::uint8_t> side;  // half of each point of the split ball; 1: the other half
    float cost;                      // cost of both halves
  };
  Halves cheapest_halves(std::span<const std::uint32_t> members, const GroupBall& before, float overlap_weight,
                         float max_cost);
  void gather(std::size_t ball);
  void place_fit(std::size_t ball, const GroupBall& fitted, float overlap_weight);
  std::vector<std::size_t> neighbors_within_growth(std::size_t ball) const;
  template <class Give>
  std::vector<float> radii_without(std::size_t ball, const Give& give) const;

  PlacedBalls balls_;
  Assignment assignment_;
  FitCache fits_;
  GroupPoints own_;                       // scratch: points of the current ball
  std::vector<std::uint32_t> own_index_;  // numbers of own_'s points
};

}  // namespace morula::detail
