// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The motion of six coordinates nearest to a goal among those that half spaces permit.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace morula::detail {

/// A translation and a rotation vector, in coordinates in which the metric is the identity.
using Motion = std::array<double, 6>;

/// The motions x with row · x ≥ offset.
struct KeptMotions {
  Motion row;
  double offset;
};

struct NearestMotion {
  Motion motion;
  bool exists = true;  ///< false: no motion is permitted by all, up to the tolerance; the motion is then the goal
  std::size_t active_count = 0;
  std::array<std::uint32_t, 6> active{};
  std::array<double, 6> weight{};  ///< 0 or more: motion = goal + sum of weight[k] × row of active[k]
};

/// The nearest permitted motion, up to `tolerance` in the offsets: Gauss's principle of least constraint as a quadratic
/// program, solved by the dual active-set method [goldfarb1983]. Deterministic. Cost: about 0.3 us per change of the
/// half spaces that hold the motion, at most 200 of them, and 5 ns per half space and change.
NearestMotion nearest_motion(const Motion& goal, std::span<const KeptMotions> sides, double tolerance);

}  // namespace morula::detail
