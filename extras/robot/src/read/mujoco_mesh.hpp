// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// MuJoCo's own binary meshes.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>

namespace morula::robot {

/// Whether this `.msh` is MuJoCo's. Gmsh's files of the same extension begin with a word.
bool is_mujoco_mesh(const std::filesystem::path& path);
/// Vertices and facets; normals and texture coordinates are skipped. Throws FileError for sizes that do not agree with
/// the file's, for indices out of range, and for a file without facets, whose hull is meant.
Mesh read_mujoco_mesh(const std::filesystem::path& path);

}  // namespace morula::robot
