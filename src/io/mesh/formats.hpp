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

/// Positions of one frame after the other, out of one file.
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

/// Readers check every number, index and size that they use; read_mesh checks the whole. path is for messages, and for
/// what a file names beside itself.
using ReadMesh = Mesh(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading);
using MeshBytes = std::string(const MeshView& mesh);
using OpenFrames = std::shared_ptr<const FrameSource>(const std::filesystem::path& path, const MotionOptions& options);

ReadMesh read_obj, read_off, read_ply, read_stl, read_gltf, read_vtk, read_vtp, read_vtu, read_gmsh;
MeshBytes obj_text, off_text, ply_bytes, stl_bytes, vtp_bytes;
OpenFrames open_gltf_frames;

/// The size is that of a binary STL with as many facets as its header counts.
bool is_exactly_binary_stl(std::string_view bytes);

/// The balls of a PLY. Throws FileError, also where it holds none.
std::vector<Sphere> read_ply_balls(const std::filesystem::path& path, std::string_view bytes);

struct MeshFormat {
  std::string_view extension;  ///< lower case, with the dot
  ReadMesh* read;
  MeshBytes* write;               ///< none: it is not written
  bool keeps_vertices;            ///< what is written reads back as the same bits, so frames may be written so
  OpenFrames* open_frames;        ///< none: a file is a single frame
  std::string_view not_written;   ///< why
  std::string_view frame_remedy;  ///< what to do about frames that differ from the mesh; empty: the usual
};
/// All that is known of formats; whoever lists, reads or writes them asks here.
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
/// Nothing where the extension is of no format.
const MeshFormat* mesh_format(std::string_view extension);
/// Of a format in which frames may be written.
bool is_frame_extension(std::string_view extension);

/// As read_mesh.
Mesh read_mesh_as(const std::filesystem::path& path, MeshReading& reading);
/// What read_mesh makes of a file with these bytes; the path says the format by its extension, which must be readable.
Mesh mesh_of_bytes(const std::filesystem::path& path, std::string_view bytes, MeshReading& reading);
/// The bytes of a file with this extension, which must be writable.
std::string mesh_bytes(std::string_view extension, const MeshView& mesh);

}  // namespace morula::detail
