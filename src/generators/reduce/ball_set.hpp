// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Ball set over a node's samples, and the three reductions of [bradshaw2004]: merge, burst, expand.
#pragma once

#include <cmath>
#include <morula/query/signed_distance.hpp>
#include <span>
#include <vector>

#include "generators/reduce/sample_set.hpp"

namespace morula::detail {

/// Balls with tables of the values that reductions read often.
class BallSet {
 public:
  /// balls, distances: equally many; distances are the signed ones of the centers. All are copied.
  BallSet(std::vector<Sphere> balls, std::vector<double> distances, std::span<const Vec3> samples);

  std::size_t size() const { return balls_.size(); }
  const Sphere& ball(std::size_t i) const { return balls_[i]; }
  /// Signed distance of the center of ball i to the object.
  double distance(std::size_t i) const { return distances_[i]; }
  const std::vector<Vec3>& samples() const { return samples_; }
  /// Distances of the center of ball i to all samples.
  std::span<const double> to_samples(std::size_t i) const {
    return std::span(to_samples_).subspan(i * samples_.size(), samples_.size());
  }
  /// Radius that ball i needs to contain these samples.
  double reach(std::size_t i, const SampleSet& of) const {
    double farthest = 0;
    of.for_each([&](std::size_t k) { farthest = std::max(farthest, to_samples(i)[k]); });
    return farthest;
  }
  /// Bound of the protrusion of ball i with this radius: (r + φ(c))⁺.
  double protrusion(std::size_t i, double radius) const { return std::max(0.0, radius + distances_[i]); }

 private:
  std::vector<Sphere> balls_;
  std::vector<double> distances_;
  std::vector<Vec3> samples_;
  std::vector<double> to_samples_;  // one row per ball
};

/// The samples that each ball owns: those inside that are deepest in it by power. Samples in no ball are strays and
/// belong to the ball with the nearest surface.
std::vector<SampleSet> samples_owned(const BallSet& set);

/// A pair of balls that are neighbors somewhere on the samples: at one sample at least, one ball is the nearest by
/// power and the other the second or third. i < j, ascending, each pair once.
struct BallPair {
  std::uint32_t i, j;
  bool operator==(const BallPair&) const = default;
  bool operator<(const BallPair& other) const { return i != other.i ? i < other.i : j < other.j; }
};
std::vector<BallPair> neighbor_pairs(const BallSet& set);

/// Balls grow out of the object by equal power, r² = s − φ(c)·|φ(c)|, so that balls of all sizes come to touch equally
/// large spots. Returns the s from which on a ball contains a point at the distance `away` from its center, which is at
/// the signed distance `distance` from the object.
inline double growth_to_contain(double distance, double away) {
  return away * away + distance * std::abs(distance);
}

/// The spheres' centers with the radii of the least growth at which they contain all samples together. Growth by power
/// is better than by radius: a sphere that could reach further takes samples off one that sticks out more. Spheres that
/// no sample needs are left out. distances: signed ones of the centers.
std::vector<Sphere> equally_grown(std::span<const Sphere> spheres, std::span<const double> distances,
                                  std::span<const Vec3> samples);

/// Signed distance of p to the object, whose surface the samples lie on. The query searches no farther than the nearest
/// sample.
double signed_distance(const SignedDistance& shape, const Vec3& p, std::span<const Vec3> samples);

/// The result of a reduction: balls that together contain all samples, at most `branching`, and their signed distances.
struct Reduced {
  std::vector<Sphere> balls;
  std::vector<double> distances;
};
// Each reduction returns nothing for no balls or samples.

/// Joins two balls, repeatedly. The joint ball is the one that sticks out least among the smallest around the samples
/// of both and those about either center. First choice: a neighbor of the ball that sticks out most, if the joint ball
/// sticks out less than it; else the pair whose joint ball sticks out least. Cost: about ten thousand small steps and
/// one closest-point query a pair, for 300 balls.
Reduced merge(const BallSet& set, std::size_t branching, const SignedDistance& shape);

/// Removes a ball, repeatedly, and gives its samples to its neighbors, which are fitted to them. First choice: the ball
/// that sticks out most among those whose neighbors then all stick out less; else the least sum of sixth powers.
Reduced burst(const BallSet& set, std::size_t branching, const SignedDistance& shape);

/// Grows all balls together and keeps few that contain all samples, at the least growth found. It makes no queries.
std::vector<Sphere> expand(const BallSet& set, std::size_t branching);

}  // namespace morula::detail
