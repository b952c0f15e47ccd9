// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins, morph targets and bones from a glTF file.
#pragma once

#include <morula/io/skin_file.hpp>

namespace morula::detail {

/// The skin of all vertices of read_mesh. Throws FileError.
Skin gltf_skin(const std::filesystem::path& path);
/// The morph targets of all vertices of read_mesh, none if the file has none. Throws FileError.
Modes gltf_targets(const std::filesystem::path& path);
/// The transforms of its bones, and the coordinates of its morph targets if with_targets, per frame. Throws FileError,
/// also if morph targets move that are not read.
BoneFrames gltf_bone_frames(const std::filesystem::path& path, bool with_targets, const MotionOptions& options);

/// Whether the name of the path is that of a glTF.
bool is_gltf(const std::filesystem::path& path);

}  // namespace morula::detail
