// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rotation and translation: the rigid placement of a body, applied after its deformation.
#pragma once

#include <array>
#include <morula/geometry/vector.hpp>
#include <string_view>

namespace morula {

/// x ↦ rotation x + translation, in double.
struct RigidTransform {
  std::array<Vec3, 3> rows{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< rows of the rotation matrix
  Vec3 translation{};

  /// The rotation by a unit quaternion (w, x, y, z). Other lengths are normalized; zero gives no rotation.
  static RigidTransform from_quaternion(double w, double x, double y, double z, const Vec3& translation = {});
  /// The right-handed rotation by an angle about an axis through the origin; a zero axis gives no rotation.
  static RigidTransform from_axis(const Vec3& axis, double angle_radians, const Vec3& translation = {});

  Vec3 rotate(const Vec3& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  /// The inverse rotation, by the transposed matrix.
  Vec3 inverse_rotate(const Vec3& v) const { return v.x * rows[0] + v.y * rows[1] + v.z * rows[2]; }
  Vec3 operator()(const Vec3& p) const { return rotate(p) + translation; }

  bool operator==(const RigidTransform&) const = default;
};

/// The transform p in the coordinates of `base`: base⁻¹ ∘ p.
RigidTransform relative_to(const RigidTransform& base, const RigidTransform& p);
RigidTransform inverse(const RigidTransform& t);

/// Largest |(R Rᵀ − I)_ij|: 0 for an exact rotation; infinity if an entry or the translation is not finite, or if R is
/// a reflection.
double deviation_from_rigid(const RigidTransform& t);
/// Largest deviation that queries accept. The results of the functions above, and products of thousands of them, are
/// within it.
inline constexpr double largest_rigid_deviation = 1e-9;

/// Largest deviation of rotations that were computed or stored in single precision, and of short products of them.
inline constexpr double largest_float_deviation = 1e-5;

/// The rotation nearest to that of t, with rows that are orthonormal up to rounding, and the translation of t. t must
/// deviate by at most largest_float_deviation.
RigidTransform orthonormalized(const RigidTransform& t);
/// t itself if it deviates by at most largest_rigid_deviation; orthonormalized(t) up to largest_float_deviation.
/// Otherwise throws std::invalid_argument with a message that begins with `what`.
RigidTransform rigid_or_throw(const RigidTransform& t, std::string_view what);

}  // namespace morula
