// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes on disk. Readers keep the number and the order of a file's vertices, because motions have the same.
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
#include <morula/geometry/weld.hpp>
#include <morula/io/files.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace morula {

/// Facts about a mesh file that the mesh read from it does not show.
struct MeshInfo {
  std::size_t polygons = 0;  ///< number of faces with more than three corners
  /// Number of concave polygons, which a fan about the first corner does not cover: ear clipping divides them.
  std::size_t concave_polygons = 0;
  /// Number of polygons that cross themselves: a fan about the first corner divides them.
  std::size_t crossing_polygons = 0;
  /// Number of polygons that are not flat: along their normal, two corners are farther apart than a tenth of their
  /// diagonal.
  std::size_t bent_polygons = 0;
  std::vector<std::string> notes;  ///< parts of the file that are not in the mesh, and possible faults of it, as text
};

/// Reads a mesh from OBJ, OFF, PLY (ascii, little and big endian), STL (ascii, binary), glTF 2.0 (.gltf, .glb), VTK
/// (.vtk, .vtp, .vtu) or Gmsh (.msh); the extension determines the format.
///
/// Convex polygons become fans of triangles about their first corner; concave polygons are divided by ear clipping. An
/// STL file has triangles without common vertices: corners with the same bits become one vertex, in the order of first
/// use. Texture coordinates, normals, colors, materials and groups are ignored.
///
/// Throws FileError for an unknown extension, for a file that is missing, truncated or malformed, for coordinates that
/// are not finite, for indices out of range, and for a file without facets.
Mesh read_mesh(const std::filesystem::path& path);
/// Reads a mesh, and writes facts about the file to `info`.
Mesh read_mesh(const std::filesystem::path& path, MeshInfo& info);

/// Reads a mesh in which adjacent facets do not share vertices, such as a glTF with hard edges or texture coordinates,
/// and merges its vertices. Without that, self-queries find pairs at distance 0 along its edges.
///
/// Vertices are merged if their positions are equal and, in a glTF, their node, their joints and weights in order, and
/// their displacements in every morph target: such vertices never move apart. weld: the map of vertices, for positions
/// of the unwelded mesh (welded_positions()), MotionOptions::weld and read_skin(). It also counts the vertices at equal
/// positions that stay apart. Throws FileError like read_mesh().
Mesh read_mesh(const std::filesystem::path& path, MeshInfo& info, MeshWeld& weld);

/// Writes a mesh to OBJ, OFF or PLY (binary, doubles); the extension determines the format. For a deformed mesh pass
/// `{positions, mesh.facets}`. read_mesh() returns positions with the same bits. The write is atomic: the path has the
/// old file until the new one is complete. Throws FileError for another extension and for a file that cannot be
/// written.
void write_mesh(const std::filesystem::path& path, const MeshView& mesh);

/// A format of mesh files.
struct MeshFileKind {
  std::string_view extension;  ///< lower case, with the dot
  bool is_written;             ///< true: write_mesh() writes it; read_mesh() reads all
};
/// The formats that read_mesh() reads.
std::span<const MeshFileKind> mesh_file_kinds();
/// The extensions that read_mesh() reads, as text for help: ".obj .off .ply .stl" and so on.
std::string readable_mesh_extensions();
/// The extensions that write_mesh() writes, as text: ".obj, .off or .ply".
std::string writable_mesh_list();

}  // namespace morula
