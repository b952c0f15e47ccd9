// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins and bones from a glTF file.
#pragma once

#include <morula/io/motion_file.hpp>
#include <morula/update/skin.hpp>
#include <vector>

namespace morula::detail {

/// The skin of all vertices of read_mesh. Throws FileError.
Skin gltf_skin(const std::filesystem::path& path);
/// The transforms of its bones, per frame. Throws FileError, also if morph targets move.
std::vector<std::vector<AffineTransform>> gltf_transforms(const std::filesystem::path& path,
                                                          const MotionOptions& options);

}  // namespace morula::detail
