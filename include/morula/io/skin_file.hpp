// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins on disk, and the transforms of their bones frame by frame: NumPy arrays or glTF.
#pragma once

#include <morula/io/motion_file.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

namespace morula {

/// Reads a skin. path: a .npy of float32 or float64 in C order, shape (vertices, bones), with rows that add up to 1
/// within 1e-3 and are then divided by their sum; or a .gltf or .glb with the mesh's vertices, whose nodes without a
/// skin count as bones of their own. Throws FileError that names the file and the mismatch.
Skin read_skin(const std::filesystem::path& path, const MeshView& mesh);

/// Reads a skin of the unwelded mesh, and returns that of the welded one: read_mesh() welded it. Throws FileError also
/// if merged vertices have different weights.
Skin read_skin(const std::filesystem::path& path, const MeshView& mesh, const MeshWeld& weld);

/// Transforms of a motion, one per frame and bone.
struct BoneFrames {
  std::size_t bone_count = 0;
  std::vector<AffineTransform> transforms;  ///< frame after frame

  std::size_t frame_count() const { return bone_count == 0 ? 0 : transforms.size() / bone_count; }
  std::span<const AffineTransform> frame(std::size_t i) const {
    return std::span(transforms).subspan(i * bone_count, bone_count);
  }
};

/// Reads transforms. path: a .npy, shape (frames, bones, 3, 4), one matrix [A | t] per frame and bone, x ↦ A x + t,
/// relative to rest; or the .gltf or .glb of the skin, whose animation is sampled by the options and must move no morph
/// targets. Throws FileError like read_skin.
BoneFrames read_bone_frames(const std::filesystem::path& path, std::size_t bone_count,
                            const MotionOptions& options = {});

/// Writes float64 arrays of the shapes above. Transforms read back to the bit, and so do weights with rows that add up
/// to exactly 1. The write is atomic and replaces an existing file. Throws FileError if the file cannot be written;
/// std::invalid_argument for data that read_skin and read_bone_frames reject: sizes and indices that do not match, no
/// bone or no frame, weights that do not add up to 1 within 1e-3, numbers that are not finite.
void write_skin(const std::filesystem::path& path, const Skin& skin);
void write_bone_frames(const std::filesystem::path& path, const BoneFrames& frames);

}  // namespace morula
