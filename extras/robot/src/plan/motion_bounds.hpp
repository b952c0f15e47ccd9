// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Bounds of how far spheres move on a part of an edge, from where they are in its middle.
#pragma once

#include <morula/geometry/vector.hpp>
#include <span>
#include <vector>

#include "plan/motion_bodies.hpp"

namespace morula::robot {

/// The robot on a part of an edge. All vectors are in world axes.
///
/// Let δ_k be the change of joint k from the middle of the part to its ends. The pose of a body at another time of the
/// part is A_1 A_2 … A_n × its pose in the middle, from the base outward, where A_k turns (or slides) by at most |δ_k|
/// about the axis that joint k has *in the middle*. Hence, with ρ_k the distance of a point from axis k in the middle:
///   first order   the point moves by at most Σ min(|δ_k|, 2) ρ_k, since the chord of an arc is at most twice its
///   radius; second order  it differs from its place in the middle + s v, −1 ≤ s ≤ 1, where v = Σ δ_k a_k × (p − o_k),
///   by at most
///                 ½ Σ_k Σ_l |δ_k δ_l| ρ'_max(k,l), where ρ'_k = ρ_k + the motion by the joints beyond k: the second
///                 derivative by joints k ≤ l has length at most ρ'_l.
/// A slide has ρ = 1 (the length of its axis) in the sums over l; it turns nothing, so it is no k of the double sum.
class MotionBounds {
 public:
  MotionBounds(const MotionBodies& bodies, const RigidTransform& base);

  /// Starts an edge.
  void set_edge(std::span<const double> from, std::span<const double> to);
  /// Goes to the part [middle − half, middle + half] of the edge.
  void set_part(double middle, double half);

  /// A node's sphere in the middle of the part, and bounds of the motion of its center.
  struct Placed {
    Vec3 center{};     ///< up to allowance()
    Vec3 velocity{};   ///< v of the center
    double speed = 0;  ///< at least the length of v
    double bend = 0;   ///< second-order bound
    double first = 0;  ///< first-order bound
    double bound() const;
  };
  /// It stays until the next part.
  const Placed& placed(std::uint32_t node) {
    if (placed_in_[node] != part_) place(node);
    return placed_[node];
  }
  /// Bounds of how two bodies move relative to each other, for all their nodes: sums of both. Joints that carry both
  /// turn the difference of two centers and leave its length; so the part of the velocities that they cause is at right
  /// angles to this difference, and nothing of it has to be subtracted.
  struct Relative {
    double bend = 0, first = 0;
  };
  const Relative& relative(std::uint32_t pair) {
    if (related_in_[pair] != part_) relate(pair);
    return relative_[pair];
  }
  /// Largest distance of a center as computed from where exact arithmetic would place it, and of a motion's bound.
  double allowance() const { return allowance_; }
  /// Largest |coordinate| of any sphere on the edge.
  double reach() const { return reach_; }

 private:
  struct Frame {
    std::array<Vec3, 3> rows{};
    Vec3 at{}, axis{};     // axis × length
    Vec3 turn{}, slide{};  // sums of δ a and of δ o × a, from the base to this joint
    double angle = 0;      // |δ|
    double angles = 0;     // sum of the |δ| of revolute joints, from the base to this joint
  };
  /// Sums over a body's joints from its own to one of them.
  struct Sums {
    double first = 0, arms = 0, bends = 0;
  };
  void measure(std::uint32_t body);
  void place(std::uint32_t node);
  void relate(std::uint32_t pair);
  Relative bounds_of(const MotionBody& body, std::uint32_t joints) const;

  const MotionBodies& bodies_;
  std::vector<Frame> frames_;
  std::vector<Sums> sums_;                             // as MotionBodies::chains
  std::vector<Placed> placed_;                         // by node
  std::vector<Relative> relative_;                     // by pair
  std::vector<std::uint64_t> placed_in_, related_in_;  // the part for which a node or pair is known
  std::uint64_t part_ = 0;                             // 2³² parts take less than an hour
  std::span<const double> from_{}, to_{};
  double deviation_ = 0, allowance_ = 0, reach_ = 0, slack_ = 1;
};

/// The configuration at a time of an edge; at 0 and 1 its ends, without rounding.
void interpolate(std::span<const double> from, std::span<const double> to, double time, std::span<double> values);

}  // namespace morula::robot
