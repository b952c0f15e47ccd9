// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Skins on disk, and the transforms of their bones frame by frame: NumPy arrays or glTF.
//
//   const morula::Skin skin = morula::read_skin("cat.glb", mesh);
//   const morula::Modes targets = morula::read_modes("cat.glb", mesh);   // its morph targets, if it has any
//   const morula::BoneFrames motion = morula::read_bone_frames("cat.glb", skin.bone_count, targets.mode_count);
//   morula::Body body(mesh, morula::build(mesh), {.rules = {morula::Rule::skinned}, .modes = targets, .skin = skin});
//   for (std::size_t i = 0; i < motion.frame_count(); ++i)
//     if (const auto status = body.update_skinned(motion.frame(i), motion.morphs.frame(i)); !status)
//       std::puts(message(status).c_str());
#pragma once

#include <concepts>
#include <morula/io/modal_file.hpp>
#include <morula/io/motion_file.hpp>
#include <morula/update/skin.hpp>
#include <span>
#include <vector>

namespace morula {

struct BoneFrames;
namespace detail {
BoneFrames read_morphed_bone_frames(const std::filesystem::path& path, std::size_t bone_count, std::size_t mode_count,
                                    const MotionOptions& options);
}  // namespace detail

/// Reads a skin. path: a .npy of float32 or float64 in C order, shape (vertices, bones), with rows that add up to 1
/// within 1e-3 and are then divided by their sum; or a .gltf or .glb with the mesh's vertices, whose nodes without a
/// skin count as bones of their own, and whose weights are divided by their sum for each vertex, of any number of sets
/// (JOINTS_0, JOINTS_1, …). Throws FileError that names the file and the mismatch, also for a vertex without weights.
Skin read_skin(const std::filesystem::path& path, const MeshView& mesh);

/// Reads a skin of the unwelded mesh, and returns that of the welded one: read_mesh() welded it. Throws FileError also
/// if merged vertices have different weights.
Skin read_skin(const std::filesystem::path& path, const MeshView& mesh, const MeshWeld& weld);

/// Transforms of a motion, one per frame and bone.
struct BoneFrames {
  std::size_t bone_count = 0;
  std::vector<AffineTransform> transforms;  ///< frame after frame
  ModalCoordinates morphs{};                ///< coordinates of morph targets, in as many frames; none if not read

  std::size_t frame_count() const { return bone_count == 0 ? 0 : transforms.size() / bone_count; }
  std::span<const AffineTransform> frame(std::size_t i) const {
    return std::span(transforms).subspan(i * bone_count, bone_count);
  }
};

/// Reads transforms. path: a .npy, shape (frames, bones, 3, 4), one matrix [A | t] per frame and bone, x ↦ A x + t,
/// relative to rest; or the .gltf or .glb of the skin, whose animation is sampled by the options and must move no morph
/// targets. Dual quaternions are no affine transforms: give Body::update() the positions that they make. Throws
/// FileError like read_skin.
BoneFrames read_bone_frames(const std::filesystem::path& path, std::size_t bone_count,
                            const MotionOptions& options = {});
/// Also reads the coordinates of the morph targets of a .gltf or .glb, for Body::update_skinned(): their weights less
/// those of the mesh at rest. mode_count: of the targets that read_modes() returns. Throws FileError also for another
/// number of targets; a .npy has none. An empty list, {}, in the place of the number means MotionOptions{}.
template <std::integral Count>
BoneFrames read_bone_frames(const std::filesystem::path& path, std::size_t bone_count, Count mode_count,
                            const MotionOptions& options = {}) {
  return detail::read_morphed_bone_frames(path, bone_count, static_cast<std::size_t>(mode_count), options);
}

/// Writes float64 arrays of the shapes above. Transforms read back to the bit, and so do weights with rows that add up
/// to exactly 1; write_coordinates() writes morphs. The write is atomic and replaces an existing file. Throws FileError
/// if the file cannot be written; std::invalid_argument for data that read_skin and read_bone_frames reject: sizes and
/// indices that do not match, no bone or no frame, weights that do not add up to 1 within 1e-3, numbers that are not
/// finite.
void write_skin(const std::filesystem::path& path, const Skin& skin);
void write_bone_frames(const std::filesystem::path& path, const BoneFrames& frames);

}  // namespace morula
