// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Poses of a rigid tool, and the screw motions between them.
#pragma once

#include <morula/geometry/rigid_transform.hpp>

namespace morula::detail {

/// A unit quaternion.
struct Rotation {
  double w = 1;
  Vec3 v{};

  /// That of a matrix. The result is a unit quaternion also for rows that are orthonormal up to rounding alone.
  static Rotation from_rows(const RigidTransform& t);
  /// The rotation by an angle of |turn| radians about the direction of `turn`.
  static Rotation from_vector(const Vec3& turn);
  /// The vector of from_vector(), of a length of at most π.
  Vec3 vector() const;
  RigidTransform rows() const { return RigidTransform::from_quaternion(w, v.x, v.y, v.z); }
  /// This rotation after `first`, normalized.
  Rotation after(const Rotation& first) const;
  Rotation inverse() const { return {w, -v}; }
};

/// A motion about the center: it moves on a straight line while the tool rotates evenly about an axis through it.
struct RigidMotion {
  Vec3 shift{}, turn{};  ///< turn: rotation vector, radians

  friend RigidMotion operator*(double share, const RigidMotion& m) { return {share * m.shift, share * m.turn}; }
};

struct ToolPose {
  Rotation rotation{};
  Vec3 center{};

  ToolPose moved(const RigidMotion& m) const {
    return {Rotation::from_vector(m.turn).after(rotation), center + m.shift};
  }
  /// The motion from this pose to another one; the rotation is the shorter one.
  RigidMotion motion_to(const ToolPose& to) const {
    return {to.center - center, to.rotation.after(rotation.inverse()).vector()};
  }
};

}  // namespace morula::detail
