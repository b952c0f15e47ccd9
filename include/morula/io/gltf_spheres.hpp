// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Spheres in motion as a scene of glTF, for Blender and other viewers: a picture, no proof.
#pragma once

#include <filesystem>
#include <morula/geometry/sphere.hpp>
#include <span>
#include <vector>

namespace morula {

/// Writes a .glb: a ball of 320 facets with its corners on the unit sphere, a node for each sphere, which shows the
/// ball moved and scaled, and where there are several frames an animation of all nodes, linear between them. Floats;
/// axes are left as they are (glTF calls y up). Needs no tinygltf. frames: at least one, each with as many spheres as
/// the first, at least one. Throws std::invalid_argument, and FileError for what does not fit into 2 GiB.
void write_gltf_spheres(const std::filesystem::path& path, std::span<const std::vector<Sphere>> frames,
                        double frames_per_second = 30);

}  // namespace morula
