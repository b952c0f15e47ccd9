// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Medial seeds: the few inscribed balls that need to grow least to contain a group's points.
#pragma once

#include <morula/geometry/reproducible.hpp>

#include "generators/fit/child_fit.hpp"

namespace morula::detail {

/// Growth of an inscribed ball: its radius by the same length for all, or the square of its radius.
enum class Dilation { length, square };

/// At most `most` of the candidates: first those of a greedy cover at the least dilation that allows one, then moved
/// one by one (points to the ball that grows least, balls to the candidate that its points need least of) while the sum
/// of points times growth falls. candidates: inscribed balls in grid coordinates. Cost: O(candidates × points ×
/// rounds).
std::vector<GroupBall> medial_seeds(std::span<const GroupBall> candidates, const GroupPoints& points, std::size_t most,
                                    Dilation dilation);

}  // namespace morula::detail
