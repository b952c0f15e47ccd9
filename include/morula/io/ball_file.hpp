// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls without a tree, on disk: for viewers and scripts.
#pragma once

#include <filesystem>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

namespace morula {

/// Writes PLY (binary, doubles): one vertex a ball, with the properties x, y, z and radius. Written whole or not at
/// all. Throws FileError for another extension and for files that cannot be written, std::invalid_argument for balls
/// that are not finite.
void write_balls(const std::filesystem::path& path, std::span<const Sphere> balls);

/// Balls of a PLY of any kind (ascii, little or big endian; other properties and elements are skipped): vertices with a
/// property `radius`, without faces. Throws FileError, also for radii that are negative or not finite.
std::vector<Sphere> read_balls(const std::filesystem::path& path);

/// Does the header of this .ply promise balls rather than a mesh? False for all other files, missing and broken ones
/// included.
bool is_ball_file(const std::filesystem::path& path);

}  // namespace morula
