// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres of all links that may be divided, and how deep they overlap in sampled configurations without a collision.
#pragma once

#include "fit/self_pieces.hpp"
#include "fit/self_samples.hpp"

namespace morula::robot {

/// The overlap of two links in a configuration.
struct Near {
  std::size_t sample = 0;   // among the free ones
  RigidTransform to_b{};    // pose of a in the axes of b
  std::vector<float> a, b;  // per part of a, of b: how deep it reaches into the other link's spheres; < 0: it is apart
  float deepest = -1;
};

/// A change of a link's parts.
struct Change {
  std::size_t link = 0, removed = none;  // none: all parts are replaced
  Pieces added{};
};

/// The depths of all pairs that come near each other in a sample in which no shapes collide.
class OverlapTable {
 public:
  /// bounds: per link a ball that contains all parts that it may get.
  OverlapTable(std::vector<Pieces> pieces, std::vector<Sphere> bounds)
      : pieces_(std::move(pieces)), bounds_(std::move(bounds)) {}

  void add(std::size_t a, std::size_t b, std::size_t sample, const RigidTransform& to_b);
  /// Ends the additions. samples: number of free samples.
  void complete(std::size_t samples, Workers& workers);

  const Pieces& pieces(std::size_t link) const { return pieces_[link]; }
  const Sphere& bound(std::size_t link) const { return bounds_[link]; }
  /// Number of samples in which some pair overlaps.
  std::size_t false_samples() const;
  /// The links that come near this one.
  std::vector<std::size_t> neighbors(std::size_t link) const;
  /// The overlaps in which a part of a link is the deepest.
  struct Blame {
    double cost = 0;
    Vec3 toward{};  // mean direction to the spheres that it overlaps, in the link's axes, of any length
  };
  std::vector<Blame> blame(std::size_t link) const;

  struct Effect {
    double gain = 0;                // decrease of the cost of all overlaps
    std::ptrdiff_t more_false = 0;  // increase of false_samples()
  };
  Effect effect(const Change& change) const;
  void apply(const Change& change, Workers& workers);

 private:
  struct Row {
    std::size_t a, b;
    double scale;  // depth that counts as deep
    std::vector<Near> near{};
  };
  double cost(const Row& row, float depth) const;
  void fill(Row& row, Near& near) const;

  std::vector<Pieces> pieces_;
  std::vector<Sphere> bounds_;
  std::vector<Row> rows_;
  std::vector<std::uint32_t> overlaps_;  // per sample: number of pairs that overlap
};

}  // namespace morula::robot
