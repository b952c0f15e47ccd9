// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Rotations in single precision, made good.
#pragma once

#include <morula/geometry/rigid_transform.hpp>
#include <string_view>

namespace morula {

/// Deviation of rotations that were computed or stored in single precision, and of short products of them.
inline constexpr double largest_float_deviation = 1e-5;

/// The rotation nearest to the one of t, its rows orthonormal to rounding, with the translation of t. t: deviates by at
/// most largest_float_deviation.
RigidTransform orthonormalized(const RigidTransform& t);
/// t itself where it deviates by at most largest_rigid_deviation; orthonormalized(t) up to largest_float_deviation.
/// Throws std::invalid_argument, which begins with `what`, for anything else.
RigidTransform rigid_or_throw(const RigidTransform& t, std::string_view what);

}  // namespace morula
