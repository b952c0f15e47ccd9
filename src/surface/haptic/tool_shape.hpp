// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The balls of a rigid tool about their center of mass, and the kinetic metric of its motions.
#pragma once

#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

#include "surface/haptic/nearest_motion.hpp"
#include "surface/haptic/tool_pose.hpp"

namespace morula::detail {

class ToolShape {
 public:
  explicit ToolShape(std::span<const Sphere> balls);

  std::size_t size() const { return arms_.size(); }
  const Vec3& center() const { return center_; }  ///< in the tool's coordinates
  double radius(std::size_t ball) const { return radii_[ball]; }
  double reach() const { return reach_; }          ///< radius of a ball about the center that contains all balls
  double arm_reach() const { return arm_reach_; }  ///< largest distance of a ball's center from the center
  Vec3 ball(std::size_t ball, const RigidTransform& rows, const ToolPose& pose) const {
    return pose.center + rows.rotate(arms_[ball]);
  }
  /// Centers of all balls at a pose.
  void place(const ToolPose& pose, std::vector<Vec3>& centers) const;

  /// The largest distance that a ball's center moves.
  double displacement(const RigidMotion& m) const { return length(m.shift) + arm_reach_ * length(m.turn); }
  /// The largest distance of a ball's center, during a motion, from its place on the segment between its ends.
  double sag(const RigidMotion& m) const { return squared_length(m.turn) * arm_reach_ / 8; }
  /// The largest rotation with this sag, radians.
  double turn_of_sag(double sag) const;

  /// Motions in coordinates in which the kinetic energy per mass is half the squared length, and back. rows: the
  /// rotation of the tool.
  Motion to_metric(const RigidMotion& m, const RigidTransform& rows) const;
  RigidMotion from_metric(const Motion& m, const RigidTransform& rows) const;
  /// The derivative of the motion of a ball's center along a normal.
  Motion row(std::size_t ball, const Vec3& normal, const RigidTransform& rows) const;
  /// Inertia per mass times a rotation vector.
  Vec3 inertia(const Vec3& turn, const RigidTransform& rows) const;

 private:
  Vec3 center_;
  std::vector<Vec3> arms_;
  std::vector<double> radii_;
  double reach_ = 0, arm_reach_ = 0;
  std::array<Vec3, 3> lower_{};  // Cholesky factor of the inertia per mass: inertia = lower × lowerᵀ
};

}  // namespace morula::detail
