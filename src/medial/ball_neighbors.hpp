// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Neighbors of balls.
#pragma once

#include <morula/medial/medial_balls.hpp>
#include <utility>

namespace morula::detail {

/// Fills neighbor_begin and neighbors from pairs of balls, given in one direction or both and any number of times.
/// Each ball's neighbors come in ascending order.
void set_neighbors(MedialBalls& medial, std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs);

/// Neighbors are balls that overlap, one of them among the `count` nearest centers of the other (ties: lower index).
/// Same bits for any number of workers. Cost: O(n log n).
void connect_overlapping(MedialBalls& medial, std::size_t count, Workers& workers);

}  // namespace morula::detail
