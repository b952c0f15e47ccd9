// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/io/mesh_file.hpp>

#include "io/first_bytes.hpp"
#include "io/mesh/formats.hpp"
#include "io/number_text.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"
#include "platform/path_text.hpp"

namespace morula {
using namespace detail;
namespace {

void require_sound_mesh(const std::filesystem::path& path, const Mesh& mesh, const MeshInfo& info) {
  if (mesh.facets.empty() && mesh.positions.empty())
    throw FileError(platform::text_of(path) +
                    ": has neither vertices nor facets: it is empty, or not what its name says" +
                    (info.notes.empty() ? "" : "; " + info.notes.front()));
  if (mesh.facets.empty())
    throw FileError(platform::text_of(path) + ": has " + std::to_string(mesh.vertex_count()) +
                    " vertices but no facets; " +
                    (info.notes.empty() ? "points and lines alone have no surface" : info.notes.front()));
  try {
    require_usable(mesh);
  } catch (const std::invalid_argument& problem) {
    throw FileError(platform::text_of(path) + ": " + problem.what());
  }
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path) {
  MeshReading reading;
  return read_mesh_as(path, reading);
}

Mesh read_mesh(const std::filesystem::path& path, MeshInfo& info) {
  MeshReading reading;
  Mesh mesh = read_mesh_as(path, reading);
  info = std::move(reading.info);
  return mesh;
}

Mesh read_mesh(const std::filesystem::path& path, MeshInfo& info, MeshWeld& weld) {
  MeshReading reading{.wants_labels = true};
  const Mesh mesh = read_mesh_as(path, reading);
  info = std::move(reading.info);
  weld = weld_vertices(mesh, reading.labels);
  return welded(mesh, weld);
}

Mesh detail::read_mesh_as(const std::filesystem::path& path, MeshReading& reading) {
  const StandardFloats standard;
  const std::string extension = lower_extension(path);
  if (mesh_format(extension) == nullptr)
    throw FileError(platform::text_of(path) + ": " +
                    (extension.empty() ? "no extension" : "extension " + in_quotes(extension)) +
                    " says no known mesh format; name a file with one of " + readable_mesh_extensions());
  return mesh_of_bytes(path, read_whole(path), reading);
}

Mesh detail::mesh_of_bytes(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading) {
  const std::string extension = lower_extension(path);
  // A binary STL begins with eighty arbitrary bytes.
  if (extension != ".stl" || !is_exactly_binary_stl(bytes)) {
    if (const std::string foreign = foreign_content(bytes, extension); !foreign.empty())
      throw FileError(platform::text_of(path) + ": " + foreign);
  }
  Mesh mesh = mesh_format(extension)->read(path, bytes, reading);
  require_sound_mesh(path, mesh, reading.info);
  return mesh;
}

void write_mesh(const std::filesystem::path& path, const MeshView& mesh) {
  const std::string extension = lower_extension(path);
  const MeshFormat* const format = mesh_format(extension);
  if (format != nullptr && format->write == nullptr)
    throw FileError(platform::text_of(path) + ": " + std::string(format->not_written) + "; use " +
                    writable_mesh_list());
  if (format == nullptr)
    throw FileError(platform::text_of(path) + ": " +
                    (extension.empty() ? "no extension" : "extension " + in_quotes(extension)) +
                    " says no mesh format that can be written; use " + writable_mesh_list());
  require_usable(mesh);
  // A written mesh must read back, unused vertices included.
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i)
    if (!is_finite(mesh.positions[i]))
      throw std::invalid_argument("vertex " + std::to_string(i) + " has a coordinate that is not finite");
  write_whole(path, mesh_bytes(extension, mesh));
}

std::span<const MeshFileKind> mesh_file_kinds() {
  // It is not constexpr: GCC with sanitizers does not treat the address of a function as a nonnull constant.
  static const auto kinds = [] {
    std::array<MeshFileKind, mesh_formats.size()> list{};
    for (std::size_t i = 0; i < list.size(); ++i)
      list[i] = {mesh_formats[i].extension, mesh_formats[i].write != nullptr};
    return list;
  }();
  return kinds;
}

std::string readable_mesh_extensions() {
  std::string list;
  for (const MeshFormat& format : mesh_formats) list += (list.empty() ? "" : " ") + std::string(format.extension);
  return list;
}

std::string writable_mesh_list() {
  std::vector<std::string> names;
  for (const MeshFormat& format : mesh_formats)
    if (format.write != nullptr) names.emplace_back(format.extension);
  std::string list = names.front();
  for (std::size_t i = 1; i < names.size(); ++i) list += (i + 1 < names.size() ? ", " : " or ") + names[i];
  return list;
}

const MeshFormat* detail::mesh_format(std::string_view extension) {
  for (const MeshFormat& format : mesh_formats)
    if (format.extension == extension) return &format;
  return nullptr;
}

bool detail::is_frame_extension(std::string_view extension) {
  const MeshFormat* const format = mesh_format(extension);
  return format != nullptr && format->write != nullptr && format->keeps_vertices;
}

std::string detail::mesh_bytes(std::string_view extension, const MeshView& mesh) {
  return mesh_format(extension)->write(mesh);
}

}  // namespace morula
