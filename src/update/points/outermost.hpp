// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The few points of a node that decide where its center is best: its core.
#pragma once

#include <cstdint>
#include <morula/geometry/vector.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// Fills `core` with those of the `owned` points that are farthest out in directions spread over the sphere, seen from
/// `center`, and those that are farthest from it; a point may occur more than once. O(owned × core).
void outermost(std::span<const LocalPoint> points, std::span<const std::uint32_t> owned, const Vec3f& center,
               std::span<std::uint32_t> core);

}  // namespace morula::detail
