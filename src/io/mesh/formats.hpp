// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// The mesh formats, one row each: readers and writers from and to bytes in memory. docs/reference/formats.md says what
// is accepted.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/sphere.hpp>
#include <morula/io/motion_file.hpp>
#include <span>
#include <string>
#include <string_view>

#include "io/mesh/reading.hpp"

namespace morula::detail {

/// The frames of one file, read one at a time.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual std::size_t frame_count() const = 0;
  /// Throws FileError for positions that are not finite.
  virtual std::vector<Vec3> frame(std::size_t i) const = 0;
  /// The facets that the frames have.
  virtual const std::vector<Facet>& facets() const = 0;
  virtual std::size_t vertex_count() const = 0;
};

/// Readers check every number, index and size that they use; read_mesh checks the whole mesh. path is for messages, and
/// for files that the file refers to.
using ReadMesh = Mesh(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading);
using MeshBytes = std::string(const MeshView& mesh);
using OpenFrames = std::shared_ptr<const FrameSource>(const std::filesystem::path& path, const MotionOptions& options);

ReadMesh read_obj, read_off, read_ply, read_stl, read_gltf, read_vtk, read_vtp, read_vtu, read_gmsh;
MeshBytes obj_text, off_text, ply_bytes, stl_bytes, vtp_bytes;
OpenFrames open_gltf_frames;

/// The size is that of a binary STL with as many facets as its header counts.
bool is_exactly_binary_stl(std::string_view bytes);

/// The balls of a PLY. Throws FileError, also if it holds none.
std::vector<Sphere> read_ply_balls(const std::filesystem::path& path, std::string_view bytes);

struct MeshFormat {
  std::string_view extension;  ///< extension in lower case, with the dot
  ReadMesh* read;
  MeshBytes* write;               ///< writer; null: the format is not written
  bool keeps_vertices;            ///< whether written positions read back as the same bits, so that frames may use the
                                  ///< format
  OpenFrames* open_frames;        ///< null: a file is a single frame
  std::string_view not_written;   ///< reason why the format is not written
  std::string_view frame_remedy;  ///< remedy for frames that differ from the mesh; empty: the usual one
};
/// The table of all formats, from which they are listed, read and written.
inline constexpr std::array mesh_formats{
    MeshFormat{".obj", read_obj, obj_text, true, nullptr, "", ""},
    MeshFormat{".off", read_off, off_text, true, nullptr, "", ""},
    MeshFormat{".ply", read_ply, ply_bytes, true, nullptr, "", ""},
    MeshFormat{".stl", read_stl, stl_bytes, false, nullptr, "",
               "STL frames lose their vertices, write them as another format"},
    MeshFormat{".gltf", read_gltf, nullptr, false, open_gltf_frames, "glTF meshes are read but not written", ""},
    MeshFormat{".glb", read_gltf, nullptr, false, open_gltf_frames, "glTF meshes are read but not written", ""},
    MeshFormat{".vtk", read_vtk, nullptr, false, nullptr, "VTK's legacy format is read but not written", ""},
    MeshFormat{".vtp", read_vtp, vtp_bytes, true, nullptr, "", ""},
    MeshFormat{".vtu", read_vtu, nullptr, false, nullptr, "VTK's unstructured grids are read but not written", ""},
    MeshFormat{".msh", read_gmsh, nullptr, false, nullptr, "Gmsh's format is read but not written", ""},
};
/// The format of an extension; null if there is none.
const MeshFormat* mesh_format(std::string_view extension);
/// Whether frames may be written with this extension.
bool is_frame_extension(std::string_view extension);

/// Reads a mesh like read_mesh.
Mesh read_mesh_as(const std::filesystem::path& path, MeshReading& reading);
/// The mesh that read_mesh returns for a file with these bytes; the extension of the path gives the format, which must
/// be readable.
Mesh mesh_of_bytes(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading);
/// The bytes of a file with this extension, whose format must be writable.
std::string mesh_bytes(std::string_view extension, const MeshView& mesh);

}  // namespace morula::detail
