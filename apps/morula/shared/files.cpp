// SPDX-FileCopyrightText: 2026 The Morula authors
// SPDX-License-Identifier: Apache-2.0
#include "shared/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <morula/io/files.hpp>
#include <morula/io/mesh_file.hpp>
#include <morula/io/spheres_file.hpp>
#include <morula/io/whole_output.hpp>
#include <platform/console.hpp>
#include <platform/files.hpp>
#include <system_error>

#include "shared/command.hpp"
#include "shared/console.hpp"
#include "shared/figures.hpp"

namespace morula::cli {
namespace {

namespace fs = std::filesystem;

const std::set<std::string> tree_extensions{".morula", ".sph", ".json", ".npz"};
const std::set<std::string> frame_tree_extensions{".morula", ".sph", ".json"};

const MeshFileKind* mesh_kind(const std::string& ending) {
  for (const MeshFileKind& kind : mesh_file_kinds()) {
    if (kind.extension == ending) return &kind;
  }
  return nullptr;
}

/// What is at a path. Throws UsageError for a name that no file can have: a trial, which has a name of its own, would
/// not notice it. Other errors are left to the trial.
fs::file_status found_at(const fs::path& path) {
  int reason = 0;
  platform::kind_of(path, reason);
  if (reason == ENAMETOOLONG)
    throw UsageError(fmt::format("{}: the name is too long; choose a shorter one", path.string()));
  std::error_code error;
  return fs::status(path, error);
}

/// Throws UsageError if it is certain that there is no such folder. A trial says why others cannot be reached, such as
/// those that this user may not see.
void require_parent(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::file_status found = fs::status(folder, error);
  if (folder.empty() || !fs::status_known(found) || fs::is_directory(found)) return;
  if (fs::exists(found))
    throw UsageError(fmt::format("{}: {} is a file, not a folder", path.string(), folder.string()));
  throw UsageError(fmt::format("{}: there is no folder {}; make it first", path.string(), folder.string()));
}

}  // namespace

std::string extension(const fs::path& path) {
  std::string text = path.extension().string();
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); });
  return text;
}

FileKind file_kind(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return FileKind::folder;
  const std::string ending = extension(path);
  if (ending == ".ply" && is_ball_file(path)) return FileKind::balls;
  if (ending == ".npz" && fs::exists(path, error)) {
    if (!holds_spheres(path)) return FileKind::motion;
    return SphereFrames(path).is_motion() ? FileKind::sphere_frames : FileKind::tree;
  }
  if (tree_extensions.count(ending) != 0) return FileKind::tree;
  if (ending == ".npy" || ending == ".pc2" || ending == ".mdd") return FileKind::motion;
  if (mesh_kind(ending) != nullptr) return FileKind::mesh;
  return FileKind::unknown;
}

Mesh load_mesh(const fs::path& path) {
  MeshInfo info;
  Mesh mesh = read_mesh(path, info);
  for (const std::string& text : info.notes) note("{}: {}", path.string(), text);
  return mesh;
}

LoadedMesh load_mesh(const fs::path& path, bool is_welded) {
  if (!is_welded) return {load_mesh(path)};
  MeshInfo info;
  MeshWeld weld;
  Mesh mesh = read_mesh(path, info, weld);
  for (const std::string& text : info.notes) note("{}: {}", path.string(), text);
  note("{}: {} of {} vertices merged into others{}", path.string(), weld.merged_count(), weld.new_vertex.size(),
       weld.kept_apart == 0
           ? ""
           : fmt::format("; {} at positions of others stay, since they may move apart from them", weld.kept_apart));
  return {std::move(mesh), std::move(weld)};
}

void note_duplicate_vertices(const std::string& path, std::size_t count, bool is_welded) {
  if (count == 0) return;
  note("{} has {} at the position of another vertex: pairs that meet there are found, as if the surface were cut; {}",
       path, counted(count, "vertex", "vertices"),
       is_welded ? "they may move apart, so --weld does not merge them; morula repair merges them" : "add --weld");
}

std::string known_kinds() {
  return fmt::format("neither a mesh ({}) nor a tree (.morula .sph .json .npz) nor balls (.ply)",
                     readable_mesh_extensions());
}

std::string motion_kinds() {
  std::string kinds = "folder of meshes, glob such as \"out/frame*.obj\", one mesh";
  std::string animated;
  const std::string meshes = readable_mesh_extensions();
  for (const FileFormat& format : file_formats()) {
    if (format.purpose != "motions" || !format.is_read) continue;
    if (meshes.find(format.extension) == std::string::npos) {
      kinds += ", " + format.extension;
    } else {
      animated += (animated.empty() ? "" : " or ") + format.extension;
    }
  }
  return animated.empty() ? kinds : fmt::format("{}, or the animation of {}", kinds, animated);
}

void require_output_place(const fs::path& path) {
  if (fs::is_directory(found_at(path)))
    throw UsageError(fmt::format("{}: is a folder; name a file in it", path.string()));
  require_parent(path, path.parent_path());
  // The file is begun and abandoned: only a trial finds all obstacles.
  const WholeFile tried(path);
}

void require_folder_place(const fs::path& path) {
  if (const fs::file_status found = found_at(path); fs::exists(found)) {
    if (!fs::is_directory(found)) throw UsageError(fmt::format("{}: is a file; name a folder", path.string()));
    const WholeFolder tried(path);
    return;
  }
  const fs::path folder = (path.has_filename() ? path : path.parent_path()).parent_path();
  require_parent(path, folder);
  const WholeFolder tried(path);
}

void require_tree_output(const fs::path& path) {
  if (tree_extensions.count(extension(path)) == 0) {
    throw UsageError(
        fmt::format("{}: trees are written as .morula (with their cover), .sph, .json or .npz", path.string()));
  }
  require_output_place(path);
}

void require_mesh_output(const fs::path& path) {
  const MeshFileKind* const kind = mesh_kind(extension(path));
  if (kind == nullptr || !kind->is_written) {
    throw UsageError(fmt::format("{}: meshes are written as {}", path.string(), writable_mesh_list()));
  }
  require_output_place(path);
}

std::vector<fs::path> trees_in(const fs::path& folder) {
  std::vector<fs::path> trees = frame_files(folder, "*", frame_tree_extensions);
  if (trees.empty()) throw UsageError(fmt::format("{}: no tree files (.sph, .json, .morula) in it", folder.string()));
  for (const fs::path& tree : trees) {
    if (extension(tree) != extension(trees.front())) {
      throw UsageError(
          fmt::format("{}: holds both {} and {}: which are the frames? Put them into a folder of their own",
                      folder.string(), trees.front().filename().string(), tree.filename().string()));
    }
  }
  return trees;
}

std::string frame_file_name(std::size_t frame, std::string_view extension) {
  return fmt::format("{:04}{}", frame, extension);
}

void require_no_foreign_files(const fs::path& folder, std::size_t frame_count, std::string_view written_extension,
                              const std::set<std::string>& extensions) {
  if (!fs::is_directory(folder)) return;
  std::set<std::string> written;
  for (std::size_t i = 0; i < frame_count; ++i) written.insert(frame_file_name(i, written_extension));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || extensions.count(extension(name)) == 0 || written.count(name) != 0) continue;
    throw UsageError(
        fmt::format("{}: holds {}, which would be read as one of the frames: delete it or name another folder",
                    folder.string(), name));
  }
}

void require_not_input(const fs::path& output, const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (input.empty() || !is_same_file(output, input)) continue;
    throw UsageError(
        fmt::format("{}: is also what is read ({}): name another output", output.string(), input.string()));
  }
  using platform::Stream;
  for (const Stream stream : {Stream::input, Stream::output, Stream::errors}) {
    if (!platform::is_stream_of(stream, output)) continue;
    throw UsageError(fmt::format("{}: is where this command's {} goes already: name another output", output.string(),
                                 stream == Stream::input ? "input comes from and nothing" : "text"));
  }
}

void require_not_input_folder(const fs::path& output, const std::vector<fs::path>& inputs) {
  require_not_input(output, inputs);
  for (const fs::path& input : inputs) {
    // A pattern such as out/frame*.obj reads its folder.
    if (input.empty() || fs::exists(input) || input.filename().string().find_first_of("*?") == std::string::npos)
      continue;
    require_not_input(output, {input.has_parent_path() ? input.parent_path() : fs::path(".")});
  }
}

void require_frames_not_input(const fs::path& folder, std::size_t frame_count, std::string_view written_extension,
                              const std::vector<fs::path>& inputs) {
  require_not_input_folder(folder, inputs);
  for (const fs::path& input : inputs) {
    const std::string name = input.filename().string();
    std::size_t frame = 0;
    const auto parsed = std::from_chars(name.data(), name.data() + name.size(), frame);
    if (parsed.ec != std::errc() || frame >= frame_count || name != frame_file_name(frame, written_extension)) continue;
    const fs::path place = input.has_parent_path() ? input.parent_path() : fs::path(".");
    if (!is_same_file(place, folder)) continue;
    throw UsageError(
        fmt::format("{}: would replace {}, which is read: name another folder", folder.string(), input.string()));
  }
}

}  // namespace morula::cli
