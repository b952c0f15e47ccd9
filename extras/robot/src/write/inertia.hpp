// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Masses and inertias in the form that simulators take.
#pragma once

#include <morula/robot/output.hpp>

namespace morula::robot {

/// The masses of a body that a simulator needs: numbers above its least ones, and moments that a solid can have.
struct BodyInertia {
  double mass = 0;
  Vec3 center{};                   ///< center of mass in the link's axes
  std::array<double, 6> matrix{};  ///< xx, xy, xz, yy, yz, zz about the center, along the link's axes
  RigidTransform axes{};           ///< its turn takes the principal axes to the link's
  Vec3 moments{};                  ///< along the principal axes
  /// Whether the matrix is so far from any rejected one that a reader may compute the moments from it. Otherwise the
  /// file gives the moments, because rounding would take them below the allowed ones.
  bool matrix_is_safe = false;
};

/// The least mass and moment that are written. MuJoCo rejects masses and moments of moving bodies below 1e-15.
inline constexpr double least_mass = 1e-12, least_moment = 1e-14;
/// The mass and moments of a body that needs any mass: a milligram and a radius of inertia of a few centimeters, in SI
/// units.
inline constexpr double token_mass = 1e-6, token_moment = 1e-9;

/// The inertia of a link: the robot's own mass and inertia. An inertia that no solid has is replaced by that of the
/// link's spheres with this mass; moments of which two are less than the third are raised by the same amount, so that
/// they are not. None for a link without a mass, unless OutputOptions::fill_masses gives it that of its spheres.
std::optional<BodyInertia> body_inertia(const Description& description, std::size_t link);

}  // namespace morula::robot
