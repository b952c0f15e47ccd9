// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Motions, modes and coordinates from arrays, whose bytes are in files or in memory. Public headers read files.
#pragma once

#include <morula/io/modal_file.hpp>
#include <morula/io/skin_file.hpp>
#include <vector>

#include "io/array/npy.hpp"

namespace morula::detail {

/// The array of a Motion's frames. Throws FileError unless it has a frame or more of so many vertices.
NpyArray motion_array(const ByteSource& source, std::size_t vertex_count);
/// One of its frames. Throws FileError for positions that are not finite.
std::vector<Vec3> motion_frame(const ByteSource& source, const NpyArray& array, std::size_t vertex_count,
                               std::size_t frame);

/// The array of a .npz that is a motion: its only one, or the one called `positions`. Throws FileError.
ByteSource motion_in_archive(const ByteSource& archive);

/// Like read_modes and read_coordinates.
Modes modes_of(const ByteSource& source, const MeshView& mesh);
ModalCoordinates coordinates_of(const ByteSource& source, std::size_t mode_count);
/// Like read_skin and read_bone_frames for .npy files.
Skin skin_of(const ByteSource& source, const MeshView& mesh);
BoneFrames bone_frames_of(const ByteSource& source, std::size_t bone_count);

}  // namespace morula::detail
