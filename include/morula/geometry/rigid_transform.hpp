// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rotation and translation: where a body is, on top of its deformation.
#pragma once

#include <array>
#include <morula/geometry/vector.hpp>
#include <string_view>

namespace morula {

/// x ↦ rotation x + translation, in double.
struct RigidTransform {
  std::array<Vec3, 3> rows{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< of the rotation matrix
  Vec3 translation{};

  /// By a unit quaternion (w, x, y, z); one of another length is normalized, zero gives no rotation.
  static RigidTransform from_quaternion(double w, double x, double y, double z, const Vec3& translation = {});
  /// By an angle about an axis through the origin, right-handed; an axis of zero gives no rotation.
  static RigidTransform from_axis(const Vec3& axis, double angle_radians, const Vec3& translation = {});

  Vec3 rotate(const Vec3& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  /// The rotation undone: that by the transposed matrix.
  Vec3 inverse_rotate(const Vec3& v) const { return v.x * rows[0] + v.y * rows[1] + v.z * rows[2]; }
  Vec3 operator()(const Vec3& p) const { return rotate(p) + translation; }

  bool operator==(const RigidTransform&) const = default;
};

/// What p does in the coordinates of `base`: base⁻¹ ∘ p.
RigidTransform relative_to(const RigidTransform& base, const RigidTransform& p);
RigidTransform inverse(const RigidTransform& t);

/// Largest |(R Rᵀ − I)_ij|: 0 for a perfect rotation; infinity when an entry or the translation is not finite, or when
/// R is a reflection.
double deviation_from_rigid(const RigidTransform& t);
/// What queries compute with: anything made by the functions above, and products of thousands of such.
inline constexpr double largest_rigid_deviation = 1e-9;

/// Deviation of rotations that were computed or stored in single precision, and of short products of them.
inline constexpr double largest_float_deviation = 1e-5;

/// The rotation nearest to the one of t, its rows orthonormal to rounding, with the translation of t. t: deviates by at
/// most largest_float_deviation.
RigidTransform orthonormalized(const RigidTransform& t);
/// t itself where it deviates by at most largest_rigid_deviation; orthonormalized(t) up to largest_float_deviation.
/// Throws std::invalid_argument, which begins with `what`, for anything else.
RigidTransform rigid_or_throw(const RigidTransform& t, std::string_view what);

}  // namespace morula
