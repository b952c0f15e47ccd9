// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Meshes on disk. The file's vertex order and count are kept: motions refer to them.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <stdexcept>
#include <string>

namespace morula {

/// A file that cannot be read or written: what() names the file, the line or byte where known, and a remedy.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads OBJ, OFF, PLY (ascii, little and big endian) or STL (ascii, binary), chosen by extension.
///
/// Polygons become triangle fans. STL has no vertices: bitwise equal corners become one (exact welding), in order of
/// first use. Texture coordinates, normals, colours, materials and groups are ignored.
/// Throws FileError: unknown extension, unreadable, truncated or malformed file, non-finite coordinates, indices out of
/// range, no facets.
Mesh read_mesh(const std::filesystem::path& path);

/// Writes OBJ, OFF or PLY (binary, doubles) by extension; text with as many digits as reading back needs to give the
/// same bits. Written whole or not at all.
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

/// Lower-case extensions with the dot that read_mesh knows, for help texts: ".obj .off .ply .stl".
std::string readable_mesh_extensions();

}  // namespace morula
