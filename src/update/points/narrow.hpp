// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The one pass over the caller's positions: from float or double anywhere to float about an origin.
#pragma once

#include <cstdint>
#include <morula/geometry/positions.hpp>
#include <span>

#include "simd/float4.hpp"

namespace morula::detail {

/// The point nearest to p whose coordinates are floats.
Vec3 nearest_floats(const Vec3& p) noexcept;

/// Returns the origin of a frame that should be at p: the nearest point whose coordinates are floats, unless its
/// distance is large compared with the body's size. Differences of floats can then be computed in float, with exactly
/// the rounded result of double precision.
Vec3 origin_near(const Vec3& p, double size) noexcept;

/// out[i] = positions[first + i] - origin, i < count: subtracted in double, then rounded to float.
/// Returns the largest |coordinate| written, infinity when one is infinite, NaN or too large for a float.
float narrow(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
             LocalPoint* out) noexcept;

/// Like narrow, but the i-th point goes to out[to[i]]. Reading in order and writing anywhere beats the reverse:
/// positions come from outside the caches, whose prefetcher follows runs, and points stay within the caches.
float narrow_scattered(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                       const std::uint32_t* to, LocalPoint* out) noexcept;

/// Like narrow, as a plain loop: for tests.
float narrow_plainly(const PositionView& positions, std::size_t first, std::size_t count, const Vec3& origin,
                     LocalPoint* out) noexcept;

}  // namespace morula::detail
