// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The one pass over the caller's positions: from float or double anywhere to float about an origin.
#pragma once

#include <cstdint>
#include <morula/geometry/positions.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// The place nearest to p whose coordinates are floats.
Vec3 nearest_floats(const Vec3& p) noexcept;

/// Where a frame's origin goes that ought to be at p: the nearest place whose coordinates are floats, unless that is
/// far away beside the body's size. Differences of floats can then be taken in float, with the very result that double
/// precision would be rounded to.
Vec3 origin_near(const Vec3& p, double size) noexcept;

/// out[i] = positions[first + i] - origin, i < count: subtracted in double, then rounded to float.
/// Returns the largest |coordinate| written, infinity when one is infinite, NaN or too large for a float.
float narrow(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
             LocalPoint* out) noexcept;

/// The same, where the i-th goes to out[to[i]]: reading in order and writing anywhere beats the reverse, as positions
/// come from outside the caches, which foresee a run, and points stay within.
float narrow_scattered(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                       const std::uint32_t* to, LocalPoint* out) noexcept;

/// The same as narrow, plainly: for tests.
float narrow_plainly(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                     LocalPoint* out) noexcept;

}  // namespace morula::detail
