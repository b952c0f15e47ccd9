// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <morula/io/modal_file.hpp>
#include <morula/io/whole_output.hpp>
#include <stdexcept>

#include "io/gltf/skin.hpp"
#include "io/motion/array_motion.hpp"
#include "parallel/float_environment.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

[[noreturn]] void fail_shape(const ByteSource& source, const NpyArray& array, const std::string& needed) {
  throw FileError(platform::text_of(source.name()) + ": the array's shape is " + array.shape_text + ", but " + needed +
                  " is needed");
}

std::string text_of_displacement(std::size_t mode, std::size_t vertex) {
  return "mode " + std::to_string(mode) + ": the displacement of vertex " + std::to_string(vertex);
}
std::string text_of_coordinate(std::size_t frame, std::size_t mode) {
  return "frame " + std::to_string(frame) + ": coordinate " + std::to_string(mode);
}

}  // namespace

Modes read_modes(const std::filesystem::path& path, const MeshView& mesh) {
  if (!is_gltf(path)) return modes_of(path, mesh);
  const StandardFloats standard;
  Modes targets = gltf_targets(path);
  if (targets.vertex_count != mesh.vertex_count())
    throw FileError(platform::text_of(path) + ": has " + std::to_string(targets.vertex_count) +
                    " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
  return targets;
}

Modes read_modes(const std::filesystem::path& path, const MeshView& mesh, const MeshWeld& weld) {
  if (weld.old_vertex.size() != mesh.vertex_count())
    throw std::invalid_argument("the weld makes " + std::to_string(weld.old_vertex.size()) +
                                " vertices, but the mesh has " + std::to_string(mesh.vertex_count()));
  const std::vector<Vec3> of_file(weld.new_vertex.size());
  const Modes modes = read_modes(path, MeshView{of_file, mesh.facets});
  Modes welded{mesh.vertex_count(), modes.mode_count, {}};
  for (std::size_t j = 0; j < modes.mode_count; ++j) {
    const std::span<const Vec3> mode = modes.mode(j);
    for (std::uint32_t v = 0; v < mode.size(); ++v)
      if (const std::uint32_t first = weld.old_vertex[weld.new_vertex[v]]; mode[v] != mode[first])
        throw FileError(platform::text_of(path) + ": vertices " + std::to_string(first) + " and " + std::to_string(v) +
                        " of the unwelded mesh are merged, but mode " + std::to_string(j) + " moves them apart");
    for (const std::uint32_t v : weld.old_vertex) welded.displacements.push_back(mode[v]);
  }
  return welded;
}

ModalCoordinates read_coordinates(const std::filesystem::path& path, std::size_t mode_count) {
  return coordinates_of(path, mode_count);
}

void write_modes(const std::filesystem::path& path, const Modes& modes) {
  if (modes.empty()) throw std::invalid_argument("there is no mode to write: a file of modes has one or more");
  // By a division, because a product of counts may overflow.
  const std::size_t count = modes.displacements.size(), vertices = modes.vertex_count;
  if (vertices == 0 ? count != 0 : count / vertices != modes.mode_count || count % vertices != 0)
    throw std::invalid_argument("the displacements are not one per mode and vertex");
  for (std::size_t i = 0; i < count; ++i)
    if (!is_finite(modes.displacements[i]))
      throw std::invalid_argument(text_of_displacement(i / vertices, i % vertices) +
                                  " is not finite; repair it where the modes are made");
  std::vector<double> values;
  values.reserve(3 * modes.displacements.size());
  for (const Vec3& u : modes.displacements) values.insert(values.end(), {u.x, u.y, u.z});
  write_whole(path, npy_bytes(values, std::array{modes.mode_count, modes.vertex_count, std::size_t{3}}));
}

void write_coordinates(const std::filesystem::path& path, const ModalCoordinates& coordinates) {
  const std::size_t modes = coordinates.mode_count;
  if (coordinates.coordinates.size() != coordinates.frame_count() * modes)
    throw std::invalid_argument("the coordinates are not as many in every frame as there are modes");
  if (coordinates.frame_count() == 0)
    throw std::invalid_argument(
        "there is no frame to write: a file of coordinates has one or more, of one mode or more");
  for (std::size_t i = 0; i < coordinates.coordinates.size(); ++i)
    if (!std::isfinite(coordinates.coordinates[i]))
      throw std::invalid_argument(text_of_coordinate(i / modes, i % modes) +
                                  " is not finite; repair it where the coordinates are made");
  write_whole(path, npy_bytes(coordinates.coordinates, std::array{coordinates.frame_count(), coordinates.mode_count}));
}

Modes detail::modes_of(const ByteSource& source, const MeshView& mesh) {
  const NpyArray array = read_npy_header(source, {{0, mesh.vertex_count(), 3}, "(modes, vertices, 3)"});
  if (array.shape[0] == 0 || array.shape[1] != mesh.vertex_count())
    fail_shape(
        source, array,
        "(modes, " + std::to_string(mesh.vertex_count()) + ", 3) for the vertices of the mesh, one mode or more,");
  Modes modes{mesh.vertex_count(), array.shape[0], {}};
  modes.displacements.reserve(modes.mode_count * modes.vertex_count);
  // Without vertices the number of modes has no limit, because no mode has a number.
  for (std::size_t j = 0; j < (modes.vertex_count == 0 ? 0 : modes.mode_count); ++j) {
    const std::size_t numbers = 3 * modes.vertex_count;
    const std::vector<double> values = read_npy_values(source, array, j * numbers, numbers);
    for (std::size_t v = 0; v < modes.vertex_count; ++v) {
      modes.displacements.push_back({values[3 * v], values[3 * v + 1], values[3 * v + 2]});
      if (!is_finite(modes.displacements.back()))
        throw FileError(platform::text_of(source.name()) + ": " + text_of_displacement(j, v) +
                        " is not finite; repair it where the array was made");
    }
  }
  return modes;
}

ModalCoordinates detail::coordinates_of(const ByteSource& source, std::size_t mode_count) {
  const NpyShape needed{{0, mode_count},
                        "(frames, modes)",
                        "(frames, " + std::to_string(mode_count) + ") for the modes given, one frame or more,"};
  const NpyArray array = read_npy_header(source, needed);
  if (array.shape[0] == 0 || array.shape[1] != mode_count) fail_shape(source, array, needed.known_words);
  ModalCoordinates result{mode_count, read_npy_values(source, array, 0, array.shape[0] * mode_count)};
  for (std::size_t i = 0; i < result.coordinates.size(); ++i)
    if (!std::isfinite(result.coordinates[i]))
      throw FileError(platform::text_of(source.name()) + ": " + text_of_coordinate(i / mode_count, i % mode_count) +
                      " is not finite; repair it where the array was made");
  return result;
}

}  // namespace morula
