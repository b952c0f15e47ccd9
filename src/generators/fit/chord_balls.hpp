// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Chord balls: balls near the object's middle, found without distance queries.
#pragma once

#include <vector>

#include "generators/fit/object_lines.hpp"

namespace morula::detail {

/// Balls about the middles of the object's chords along lines of all three axes, as large as the ends of the chord and
/// 1,000 samples of the surface let them be. So they contain the ball inscribed about the same center, and exceed it by
/// no more than the distance of samples. At most `most`, spread evenly; none if the object has no inside. Chords that
/// run along the surface are left out: their middles are near one side. Mesh units. Cost: O(F + lines + balls ×
/// samples).
std::vector<Sphere> chord_balls(const MeshView& mesh, const ObjectLines& lines, std::size_t most, std::uint64_t seed);

}  // namespace morula::detail
