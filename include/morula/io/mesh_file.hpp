// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes on disk. The file's vertex order and count are kept: motions refer to them.
//
//   const morula::Mesh read = morula::read_mesh("limb.obj");  // by extension
//   morula::write_mesh("limb.ply", read);
//   try {
//     static_cast<void>(morula::read_mesh("absent.obj"));
//   } catch (const morula::FileError& error) {
//     std::puts(error.what());  // names the file, and the line where there is one
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
  std::size_t polygons = 0;           ///< faces of more than three corners
  std::size_t concave_polygons = 0;   ///< polygons that facets about the first corner would leave; ears are cut off
  std::size_t crossing_polygons = 0;  ///< polygons that cross themselves; facets about the first corner all the same
  /// Polygons that no plane fits: corners are more than a tenth of the polygon's diagonal apart along its normal.
  std::size_t bent_polygons = 0;
  std::vector<std::string> notes;  ///< parts of the file that are not in the mesh, and doubts about it, as text
};

/// Reads OBJ, OFF, PLY (ascii, little and big endian), STL (ascii, binary), glTF 2.0 (.gltf, .glb), VTK (.vtk, .vtp,
/// .vtu) or Gmsh (.msh), chosen by extension.
///
/// Convex polygons become triangle fans about their first corner, concave ones are cut by ears. STL has no vertices:
/// bitwise equal corners become one (exact welding), in order of first use. Texture coordinates, normals, colors,
/// materials and groups are ignored.
/// Throws FileError: unknown extension, unreadable, truncated or malformed file, non-finite coordinates, indices out of
/// range, no facets.
Mesh read_mesh(const std::filesystem::path& path);
/// The same, with what a user may have to know about the file.
Mesh read_mesh(const std::filesystem::path& path, MeshInfo& info);

/// Writes OBJ, OFF or PLY (binary, doubles) by extension, in any pose: `{positions, mesh.facets}`; text with as many
/// digits as reading back needs to give the same bits. Written whole or not at all.
void write_mesh(const std::filesystem::path& path, const MeshView& mesh);

struct MeshFileKind {
  std::string_view extension;  ///< lower case, with the dot
  bool is_written;             ///< by write_mesh; all are read
};
/// Every format that read_mesh knows.
std::span<const MeshFileKind> mesh_file_kinds();
/// Their extensions, for help texts: ".obj .off .ply .stl .gltf .glb".
std::string readable_mesh_extensions();
/// Those of the formats that write_mesh knows: ".obj, .off or .ply".
std::string writable_mesh_list();

}  // namespace morula
