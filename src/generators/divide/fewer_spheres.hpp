// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Fewer spheres: the leaves of a flat set, joined one pair after the other.
#pragma once

#include "generators/divide/node_fit.hpp"
#include "generators/driver/union_volume.hpp"

namespace morula::detail {

/// A set that loses one sphere with every join(). Every sphere contains the region that it owns at every moment, and
/// the regions together stay those of the leaves at the start.
class FewerSpheres {
 public:
  /// input: borrowed; its lines are those that spheres are fitted by. total: borrowed; what outside() is measured by.
  /// leaves: at least one.
  FewerSpheres(const FitInput& input, UnionVolume& total, std::vector<BuildNode> leaves);

  /// Joins the two leaves whose common sphere adds least to the space that the two take in, and fits that sphere beside
  /// all others. False where a single leaf is left, which stays.
  /// Cost: O(corners of both + lines over the common sphere × spheres near it).
  bool join();
  const std::vector<BuildNode>& leaves() const { return leaves_; }
  double outside() const { return outside_; }  ///< of the union, mesh units cubed

 private:
  // Two leaves, first < second, and the smallest sphere around what they own.
  struct Pair {
    std::size_t first, second;
    Vec3 center;  // of that sphere
    double cost;  // what it takes in more than the two do, space of other leaves included
  };
  // What pairs of a leaf are judged by.
  struct Judged {
    std::vector<Vec3> extremes;  // of the region: they decide how large a ball around it must be; lattice cells
    double outside = 0;          // of the sphere
  };

  const Judged& judged(std::size_t leaf);
  Pair pair_of(std::size_t first, std::size_t second);
  void add_pairs(std::size_t leaf);
  void measure();

  const FitInput& input_;
  UnionVolume& total_;
  UnionVolume of_pairs_;
  std::vector<BuildNode> leaves_;
  std::vector<Judged> judged_;  // of each leaf; no points before it is asked for
  std::vector<Pair> pairs_;
  double outside_ = 0;
};

}  // namespace morula::detail
