// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Balls without a tree, on disk: for viewers and scripts.
#pragma once

#include <filesystem>
#include <morula/geometry/sphere.hpp>
#include <span>

namespace morula {

/// Writes PLY (binary, doubles): one vertex a ball, with the properties x, y, z and radius. Written whole or not at
/// all. Throws FileError for another extension and for files that cannot be written, std::invalid_argument for balls
/// that are not finite.
void write_balls(const std::filesystem::path& path, std::span<const Sphere> balls);

}  // namespace morula
