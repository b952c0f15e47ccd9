// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes on disk. Readers keep the file's vertex order and count, because motions refer to them.
//
//   const morula::Mesh read = morula::read_mesh("limb.obj");  // by extension
//   morula::write_mesh("limb.ply", read);
//   try {
//     static_cast<void>(morula::read_mesh("absent.obj"));
//   } catch (const morula::FileError& error) {
//     std::puts(error.what());  // names the file, and the line if there is one
//   }
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <morula/io/files.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// Facts about a mesh file that its mesh does not show.
struct MeshInfo {
  std::size_t polygons = 0;  ///< faces with more than three corners
  /// Polygons that a fan about the first corner would not cover; split by ear clipping.
  std::size_t concave_polygons = 0;
  std::size_t crossing_polygons = 0;  ///< polygons that cross themselves; split into a fan about the first corner
  /// Polygons that are not flat: corners are more than a tenth of the polygon's diagonal apart along its normal.
  std::size_t bent_polygons = 0;
  std::vector<std::string> notes;  ///< parts of the file that are not in the mesh, and doubts about it, as text
};

/// Reads OBJ, OFF, PLY (ascii, little and big endian), STL (ascii, binary), glTF 2.0 (.gltf, .glb), VTK (.vtk, .vtp,
/// .vtu) or Gmsh (.msh), selected by extension.
///
/// Convex polygons become triangle fans about their first corner; concave polygons are split by ear clipping. STL has
/// no vertices: bitwise equal corners become one vertex (exact welding), in order of first use. Texture coordinates,
/// normals, colors, materials and groups are ignored. Throws FileError: unknown extension, unreadable, truncated or
/// malformed file, non-finite coordinates, indices out of range, no facets.
Mesh read_mesh(const std::filesystem::path& path);
/// Reads a mesh, with facts about the file for the user.
Mesh read_mesh(const std::filesystem::path& path, MeshInfo& info);

/// Writes OBJ, OFF or PLY (binary, doubles) by extension, in any pose: `{positions, mesh.facets}`. Text has enough
/// digits to read back the same bits. The write is atomic.
void write_mesh(const std::filesystem::path& path, const MeshView& mesh);

struct MeshFileKind {
  std::string_view extension;  ///< lower case, with the dot
  bool is_written;             ///< write_mesh supports the format; read_mesh supports all
};
/// Every format that read_mesh supports.
std::span<const MeshFileKind> mesh_file_kinds();
/// The extensions that read_mesh supports, for help texts: ".obj .off .ply .stl .gltf .glb".
std::string readable_mesh_extensions();
/// The extensions that write_mesh supports: ".obj, .off or .ply".
std::string writable_mesh_list();

}  // namespace morula
