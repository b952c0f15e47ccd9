// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
// Paths: the kind of file that a name stands for, and checks against harmful outputs.
#pragma once

#include <filesystem>
#include <morula/geometry/mesh.hpp>
#include <morula/geometry/weld.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace morula::cli {

enum class FileKind { mesh, tree, balls, sphere_frames, motion, folder, unknown };
/// By extension; folders, and what is in a .ply or .npz, by looking.
FileKind file_kind(const std::filesystem::path& path);
/// Lower case, with the dot.
std::string extension(const std::filesystem::path& path);

/// read_mesh, which prints the notes on the file.
Mesh load_mesh(const std::filesystem::path& path);
/// A mesh, and the vertices that --weld merged in it.
struct LoadedMesh {
  Mesh mesh;
  std::optional<MeshWeld> weld{};
  /// For MotionOptions::weld: null without --weld.
  const MeshWeld* merged() const { return weld ? &*weld : nullptr; }
};
/// read_mesh, with a weld if so requested, which also prints how many vertices were merged.
LoadedMesh load_mesh(const std::filesystem::path& path, bool weld);
/// "FILE has 8 vertices at the position of another vertex: …": a note for queries of a surface with itself; none
/// without such vertices. is_welded: the mesh was read with a weld.
void note_duplicate_vertices(const std::string& path, std::size_t count, bool is_welded);

/// The forms of a motion, for help texts: "folder of meshes, glob such as "out/frame*.obj", one mesh, .npy, …, or the
/// animation of .gltf or .glb". From the table of file formats.
std::string motion_kinds();

/// "neither a mesh (.obj …) nor a tree (.morula …) nor balls": of a file that is none of those that a command takes.
std::string known_kinds();

/// Throws UsageError unless the extension is one of those written and the file can be made there, which is tried: long
/// work must not end in a typing mistake, or in a folder that may not be written to.
void require_tree_output(const std::filesystem::path& path);
void require_mesh_output(const std::filesystem::path& path);
void require_output_place(const std::filesystem::path& path);
/// The same of a folder, which may be there.
void require_folder_place(const std::filesystem::path& path);

/// The .sph, .json and .morula files of a folder, digits in names compared as numbers. Throws UsageError when there are
/// none or several kinds, FileError when a frame is missing in between.
std::vector<std::filesystem::path> trees_in(const std::filesystem::path& folder);

/// "0000.sph": how frames are named, in the order of their numbers.
std::string frame_file_name(std::size_t frame, std::string_view extension);

/// Throws UsageError when the folder already holds files with one of these extensions that will not be overwritten:
/// they would be read as frames of this output.
void require_no_foreign_files(const std::filesystem::path& folder, std::size_t frame_count,
                              std::string_view written_extension, const std::set<std::string>& extensions);

/// Throws UsageError when the output is one of the inputs, by whatever links and names, or the file that this command's
/// own text goes to: it would be lost. Inputs that are empty were not given; those that are missing are no output.
void require_not_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs);
/// The same for a folder, which may also be read as a pattern.
void require_not_input_folder(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs);
/// And nor may a frame that is written be one of them.
void require_frames_not_input(const std::filesystem::path& folder, std::size_t frame_count,
                              std::string_view written_extension, const std::vector<std::filesystem::path>& inputs);

}  // namespace morula::cli
