// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Modal models on disk: NumPy arrays of modes, and of their coordinates frame by frame.
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

/// Reads modes. path: a .npy of float32 or float64 in C order, shape (modes, vertices, 3): displacements in mesh units
/// per unit of a mode's coordinate. Throws FileError that names the file, the actual and the required shape, or the
/// first number that is not finite.
Modes read_modes(const std::filesystem::path& path, const MeshView& mesh);

/// Coordinates of a motion, one per frame and mode.
struct ModalCoordinates {
  std::size_t mode_count = 0;
  std::vector<double> coordinates;  ///< frame after frame

  std::size_t frame_count() const { return mode_count == 0 ? 0 : coordinates.size() / mode_count; }
  std::span<const double> frame(std::size_t i) const {
    return std::span(coordinates).subspan(i * mode_count, mode_count);
  }
};

/// Reads coordinates. path: a .npy of float32 or float64 in C order, shape (frames, modes), at least one frame. Throws
/// FileError like read_modes.
ModalCoordinates read_coordinates(const std::filesystem::path& path, std::size_t mode_count);

/// Writes float64 arrays that read_modes and read_coordinates read back to the bit. The write is atomic and replaces an
/// existing file. Throws FileError if the file cannot be written; std::invalid_argument for data that they reject:
/// sizes that do not match, no mode or no frame, numbers that are not finite.
void write_modes(const std::filesystem::path& path, const Modes& modes);
void write_coordinates(const std::filesystem::path& path, const ModalCoordinates& coordinates);

}  // namespace morula
