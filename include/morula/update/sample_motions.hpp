// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modes and bones made by formula, for trying out bodies that do not come with positions: no files needed.
#pragma once

#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

namespace morula {

/// Sine bending modes of a body along x, as of a thin beam. With s = 0…1 along the box of the positions and L its
/// length, mode j = 0, 1, … has k = j / 2 + 1 half waves and moves the axis by w = (L / 10) sin(k π s), in y where j is
/// even and in z where it is odd. Cross sections stay at right angles to the axis: a vertex h above the middle of the
/// box, in that direction, also moves along x by -h dw/dx. Same bits everywhere.
/// Throws std::invalid_argument without positions, or when these have no length along x.
Modes sample_modes(std::span<const Vec3> rest, std::size_t mode_count = 4);

/// Coordinates of frame_count frames, frame after frame: mode j swings as sin(2 π (j + 1) t) / (j + 1), with t from 0
/// in the first frame to 1 in the last. The first frame is rest exactly.
std::vector<double> sample_coordinates(std::size_t mode_count, std::size_t frame_count);

/// Two bones, one on each side of a joint in the middle of the box of the positions. The weight of the second goes from
/// 0 to 1 smoothly, over the middle fifth of the length along x. Throws like sample_modes.
Skin sample_skin(std::span<const Vec3> rest);

/// Transforms of that skin's bones, frame after frame: the first bone stays, the second turns about the joint, in the
/// x-y plane, to 60 degrees and back. The first and the last frame are rest exactly.
std::vector<AffineTransform> sample_bones(std::span<const Vec3> rest, std::size_t frame_count);

}  // namespace morula
