// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MuJoCo's own binary meshes.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>

namespace morula::robot {

/// Is this `.msh` MuJoCo's? Gmsh's, of the same name, begin with a word.
bool is_mujoco_mesh(const std::filesystem::path& path);
/// Vertices and facets; normals and places in textures are passed over. Throws FileError for sizes that do not agree
/// with the file's, for indices out of range, and for a file without facets, whose hull is meant.
Mesh read_mujoco_mesh(const std::filesystem::path& path);

}  // namespace morula::robot
