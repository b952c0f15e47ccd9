// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modal models on disk: a NumPy array of modes, or the morph targets of a glTF, and an array of coordinates for each
// frame of a motion.
//
//   const morula::Modes modes = morula::read_modes("modes.npy", mesh);
//   const morula::ModalCoordinates motion = morula::read_coordinates("motion.npy", modes.mode_count);
//   morula::Body body(mesh, morula::build(mesh), {.rules = {morula::Rule::modal}, .modes = modes});
//   for (std::size_t frame = 0; frame < motion.frame_count(); ++frame)
//     if (const auto status = body.update_modal(motion.frame(frame)); !status) std::puts(message(status).c_str());
#pragma once

#include <morula/geometry/mesh.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/update/modes.hpp>

namespace morula {

/// Reads the modes of a mesh from a .npy file of float32 or float64 in C order and of the shape (modes, vertices, 3):
/// the displacement of each vertex at coordinate 1 of each mode, mesh units. Or from a .gltf or .glb with the mesh's
/// vertices: its morph targets, one mode per target of each node that shows a mesh, in order; without targets there
/// are 0 modes. Throws FileError for a file that is missing or no such array, for another shape, with both shapes, and
/// for a number that is not finite, with its index.
Modes read_modes(const std::filesystem::path& path, const MeshView& mesh);
/// Reads modes of the unwelded mesh, and returns those of the welded one: read_mesh() welded it. Throws FileError also
/// if merged vertices have different displacements.
Modes read_modes(const std::filesystem::path& path, const MeshView& mesh, const MeshWeld& weld);

/// The coordinates of a motion: one number per frame and mode.
struct ModalCoordinates {
  std::size_t mode_count = 0;
  std::vector<double> coordinates;  ///< frame after frame, mode_count numbers each

  std::size_t frame_count() const { return mode_count == 0 ? 0 : coordinates.size() / mode_count; }
  /// The coordinates of a frame, for Body::update_modal().
  std::span<const double> frame(std::size_t i) const {
    return std::span(coordinates).subspan(i * mode_count, mode_count);
  }
};

/// Reads the coordinates of a motion from a .npy file of float32 or float64 in C order and of the shape (frames,
/// modes), with at least one frame. mode_count: Modes::mode_count. Throws FileError like read_modes().
ModalCoordinates read_coordinates(const std::filesystem::path& path, std::size_t mode_count);

/// Writes modes as a .npy of float64, from which read_modes() returns the same bits. The write is atomic: the path has
/// the old file until the new one is complete. Throws FileError if the file cannot be written, and
/// std::invalid_argument for data that read_modes() rejects: sizes that do not match, no mode, numbers that are not
/// finite.
void write_modes(const std::filesystem::path& path, const Modes& modes);
/// Writes coordinates as a .npy of float64, from which read_coordinates() returns the same bits. Otherwise like
/// write_modes().
void write_coordinates(const std::filesystem::path& path, const ModalCoordinates& coordinates);

}  // namespace morula
