// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres as SOFA's SphereLoader reads them. Its files end in .sph, too, and are not the toolkit's.
#pragma once

#include <filesystem>
#include <morula/geometry/sphere.hpp>
#include <span>

namespace morula {

/// Writes `sph 1.0`, `nums N` and a line `sphe index x y z r` for each sphere, with the fewest digits that read back as
/// the same bits. Throws std::invalid_argument for numbers that are not finite.
void write_sofa_spheres(const std::filesystem::path& path, std::span<const Sphere> spheres);

}  // namespace morula
