// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include <morula/io/mesh_file.hpp>

#include "io/mesh/formats.hpp"
#include "io/number_text.hpp"
#include "io/whole_file.hpp"
#include "parallel/float_environment.hpp"

namespace morula {
namespace {

void require_sound(const std::filesystem::path& path, const Mesh& mesh) {
  if (mesh.facets.empty())
    throw FileError(path.string() + ": has " + std::to_string(mesh.vertex_count()) +
                    " vertices but no facets; points and lines alone have no surface");
  try {
    require_usable(mesh);
  } catch (const std::invalid_argument& problem) {
    throw FileError(path.string() + ": " + problem.what());
  }
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path) {
  const StandardFloats standard;
  const std::string extension = lower_extension(path);
  if (!is_readable_mesh_extension(extension))
    throw FileError(path.string() + ": " + (extension.empty() ? "no extension" : "extension " + in_quotes(extension)) +
                    " says no known mesh format; name a file with one of " + readable_mesh_extensions());
  return mesh_of_bytes(path, read_whole(path));
}

Mesh mesh_of_bytes(const std::filesystem::path& path, std::string_view bytes) {
  const std::string extension = lower_extension(path);
  Mesh mesh;
  if (extension == ".obj") mesh = read_obj(path, bytes);
  if (extension == ".off") mesh = read_off(path, bytes);
  if (extension == ".ply") mesh = read_ply(path, bytes);
  if (extension == ".stl") mesh = read_stl(path, bytes);
  require_sound(path, mesh);
  return mesh;
}

void write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  const std::string extension = lower_extension(path);
  if (extension == ".stl")
    throw FileError(path.string() +
                    ": STL is read but not written, since it loses the vertices; use .obj, .off or .ply");
  if (!is_writable_mesh_extension(extension))
    throw FileError(path.string() + ": " + (extension.empty() ? "no extension" : "extension " + in_quotes(extension)) +
                    " says no mesh format that can be written; use .obj, .off or .ply");
  require_usable(mesh);
  // What is written must read back, unused vertices included.
  for (std::size_t i = 0; i < mesh.vertex_count(); ++i)
    if (!is_finite(mesh.positions[i]))
      throw std::invalid_argument("vertex " + std::to_string(i) + " has a coordinate that is not finite");
  write_whole(path, mesh_bytes(extension, mesh.positions, mesh.facets));
}

std::string readable_mesh_extensions() {
  return ".obj .off .ply .stl";
}

bool is_readable_mesh_extension(std::string_view extension) {
  return extension == ".stl" || is_writable_mesh_extension(extension);
}

bool is_writable_mesh_extension(std::string_view extension) {
  return extension == ".obj" || extension == ".off" || extension == ".ply";
}

std::string mesh_bytes(std::string_view extension, std::span<const Vec3> positions, std::span<const Facet> facets) {
  if (extension == ".obj") return obj_text(positions, facets);
  return extension == ".off" ? off_text(positions, facets) : ply_bytes(positions, facets);
}

}  // namespace morula
