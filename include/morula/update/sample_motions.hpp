// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Generated modes and bones for first experiments with bodies that positions do not drive, without files.
#pragma once

#include <morula/update/modes.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

namespace morula {

/// Sine bending modes of a body along x, like those of a thin beam. With s = 0…1 along the box of the positions and L
/// its length, mode j = 0, 1, … has k = j / 2 + 1 half waves and moves the axis by w = (L / 10) sin(k π s), in y for
/// even j and in z for odd j. Cross sections stay at right angles to the axis: a vertex h above the middle of the box,
/// in that direction, also moves along x by -h dw/dx. The result has the same bits on all machines. Throws
/// std::invalid_argument without positions, or if these have no length along x.
Modes sample_modes(std::span<const Vec3> rest, std::size_t mode_count = 4);

/// Coordinates of frame_count frames, frame after frame: mode j oscillates as sin(2 π (j + 1) t) / (j + 1), with t from
/// 0 in the first frame to 1 in the last. The first frame is exactly rest.
std::vector<double> sample_coordinates(std::size_t mode_count, std::size_t frame_count);

/// Two bones, one on each side of a joint in the middle of the box of the positions. The weight of the second bone
/// rises smoothly from 0 to 1 over the middle fifth of the length along x. Throws like sample_modes.
Skin sample_skin(std::span<const Vec3> rest);

/// Transforms of that skin's bones, frame after frame: the first bone stays; the second rotates about the joint, in the
/// x-y plane, to 60 degrees and back. The first and the last frame are exactly rest.
std::vector<AffineTransform> sample_bones(std::span<const Vec3> rest, std::size_t frame_count);

}  // namespace morula
