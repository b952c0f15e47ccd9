// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The children of one node while their places are sought: balls over points of the node's region, moved to where they
// take in least empty space together.
#pragma once

#include <cstdint>
#include <limits>
#include <morula/geometry/random.hpp>
#include <span>
#include <unordered_set>
#include <vector>

#include "generators/fit/ball_fit.hpp"

namespace morula::detail {

class Group {
 public:
  struct Settings {
    float taken_while_splitting = 0.6F;  // what space that siblings take in counts, early and late
    float taken = 0.15F;
    float part = 1;           // width of a child's part of the surface, in cells
    float balance = 0;        // weight of unequal demand among children
    bool asks_again = false;  // about splits that were refused as all stands: the same balls, later
  };
  /// grid, points, shape: borrowed. most: balls wanted. start: the node's own ball, mesh coordinates.
  Group(OutsideGrid& grid, const GroupPoints& points, const ObjectShape& shape, std::size_t most, const Sphere& start,
        const Settings& settings, std::uint64_t seed);

  /// One ball over all points, then split until there are as many as wanted or splitting does not pay.
  void split_from_one();
  /// Takes these balls: points go to the one of least power. fill_places: sweeps may place further balls.
  void take(std::span<const Sphere> balls, bool fill_places = true);
  void take_in_grid(std::span<const GroupBall> balls);
  /// Points to the ball of least power, balls fitted to their points, unused ones placed by splitting.
  void sweep(float taken, bool exclusive);
  /// Points to the inscribed ball of least power: for balls that have settled where they are but not where they should.
  void sweep_inscribed(float taken);
  /// Random changes, kept when they help: every move_every-th moves a ball elsewhere, the others nudge walls.
  void try_changes(int count, int move_every);
  /// Settles on whichever is better: as it is, or after sweeps by inscribed power.
  void try_inscribed(int inscribed_sweeps, int sweeps);
  void try_seeds(std::span<const GroupBall> seeds, int inscribed_sweeps, int sweeps);
  void try_spheres(std::span<const Sphere> balls, int sweeps);

  /// Empty space that the balls take in together, and what balance adds.
  double objective();
  /// Fits a ball to other points, with all balls of this group but the nearest to the first start in place.
  GroupBall refit_to(GroupPoints points, std::span<const Vec3f> starts);
  std::vector<Sphere> spheres() const;

 private:
  // When a ball last changed and was last fitted, and to what: a ball whose points and neighbours are the same as then
  // fits already.
  struct Fit {
    std::uint64_t changed = 0, fitted = 0, points = 0;
    float taken = -1;
    GroupBall before{};  // the last change
  };
  struct State {
    std::vector<GroupBall> balls;
    std::vector<std::uint8_t> owner;
    std::vector<Fit> fits;
  };
  std::vector<GroupBall> in_grid(std::span<const Sphere> balls) const;
  State snapshot() const { return {balls_, owner_, fits_}; }
  bool fits_already(std::size_t ball, float taken) const;
  void place(std::size_t ball, const GroupBall& fitted, float taken);
  void restore(const State& state);
  void clear_grid();
  bool used(std::size_t i) const { return count_[i] > 0; }
  void recount();
  template <class Visit>
  void each_owned(std::size_t ball, const Visit& visit) const;
  void gather(std::size_t ball);
  void give_what_others_contain(std::size_t ball);
  void refit(std::size_t ball, float taken, float first_step);
  void assign_by_power(std::span<const float> squared_radii);
  void fill(float taken);
  bool split(std::size_t ball, std::size_t into, float taken, float most_cost_factor);
  float key(std::size_t ball) const;
  std::uint64_t hash_of(std::size_t ball, float taken) const;
  template <class Give>
  std::vector<float> reach_without(std::size_t ball, const Give& give) const;
  float growth_without(std::size_t ball) const;
  // missed: by how much siblings would have to grow without each ball; empty when not known.
  void teleport(std::vector<float>& missed);
  void nudge();
  double imbalance() const;

  OutsideGrid& grid_;
  const GroupPoints& points_;
  const ObjectShape& shape_;
  std::size_t most_;
  GroupBall start_;
  Settings settings_;
  Random random_;
  double scale_ = -1;  // of the balance term: the cost at the start
  std::vector<GroupBall> balls_;
  std::vector<std::uint8_t> owner_;
  std::vector<std::uint32_t> count_;  // points of each ball
  std::vector<float> demand_;
  std::vector<std::uint64_t> points_hash_;  // of the set of points of each ball
  std::vector<Fit> fits_;
  std::uint64_t clock_ = 0;
  bool fill_places_ = true;
  std::vector<std::uint8_t> refused_;  // splitting it did not pay
  // Hashes of balls of which that is so, with their points and cost. Where siblings move, the cost changes.
  std::unordered_set<std::uint64_t> better_whole_;
  // What the last assignment by power went by, and what came of it.
  struct Powered {
    Vec3f center;
    float square = std::numeric_limits<float>::quiet_NaN();
  };
  std::vector<Powered> powered_;
  std::vector<float> powers_;  // of each point's owner
  std::vector<std::uint32_t> power_owner_;
  std::vector<std::uint64_t> mixed_;  // of each point, for points_hash_
  GroupPoints own_;                   // scratch: points of the ball being fitted
  std::vector<std::uint32_t> own_index_;
};

}  // namespace morula::detail
